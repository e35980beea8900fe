"""What Python finds of a controller of a study with other settings, to compare a page with."""

from dataclasses import replace

import numpy as np
from hosted_report import law_at_rest

import clepsydra as cl
from clepsydra.engine.kernel import Kernel
from clepsydra.loop.closed_loop import closed_loop
from clepsydra.loop.loop import Loop
from clepsydra.report.analysis_tables import margin_table
from clepsydra.report.figures import figures_of
from clepsydra.report.quantities import display_factor


class Changed:
    """A controller of a study with other values, run as the page runs it.

    `result`: the study; `data`: what its report carries; `told`: what the page asked for.
    """

    def __init__(self, result, data, told):
        self.live = live = data["controllers"][told["controller"]]
        self.result, self.before = result, result.ranking[live["controller"]]
        law, values = self.before.controller.law, told["values"]
        begun = law_at_rest(data, live, values).tolist()
        self.controller = replace(
            self.before.controller,
            values=dict(zip((each.name for each in law.parameters), values, strict=True)),
            initial_state=dict(zip((each.name for each in law.state), begun, strict=True)),
        )
        self.substeps = self.before.run.substeps
        self.loop = Loop(self.controller, result.plant.measured)

    def curve(self, shown):
        """Return a row of charts, by the study's own kernel."""
        return shown.values(self._run)

    def bits(self, shown):
        """Return the same by a kernel that fuses nothing."""
        name = shown.signal.name
        names = f"{name}.true" if name == shown.measurement else name, f"{name}.running"
        return [self._unfused[each] for each in names if each in self._unfused][-1] * (
            display_factor(shown.signal)
        )

    def run(self):
        """Run both kernels."""
        result, loop = self.result, self.loop
        self._run = loop.run(result.scenario, substeps=self.substeps)
        program = closed_loop(
            result.process, self.controller, substeps=self.substeps,
            constant=loop.fixed(result.scenario), readings=True,
        )  # fmt: skip
        found = Kernel(program, fuse=False).run(
            result.scenario.samples,
            inputs=loop.inputs_of(result.scenario),
            state=loop.initial_state(),
            parameters=loop.law_parameters(),
        )
        self._unfused = {each.name: found.output(each.name)[0] for each in program.outputs}

    def judged(self, columns):
        """Return the numbers of columns of the ranking, max|S| and the margins."""
        result = self.result
        (own,) = cl.study(result.plant, controllers=[self.controller]).ranking
        assert own.run.substeps == self.substeps
        keys = [each["key"] for each in self.live["scores"]]
        figures = {figure.title: figure for figure in figures_of(result.process)}
        found = []
        for column in columns:
            value = np.nan
            if column["kind"] == "multiples":
                means = [
                    np.mean([multiple(own.scores[keys[each["score"]]], each) for each in group])
                    for group in column["groups"]
                ]
                value = np.mean(means) / column["least"]
            elif column["kind"] == "figure":
                figure = figures[column["title"]]
                worst = figure.worst(result.process, own)
                if worst is not None:
                    value = figure.compared(result.process, *worst)
            found.append(value)
        return found, own.maximum_sensitivity, margin_table(own.response)


def multiple(value, of):
    """Return a score as a multiple of the best, of which some counts as nothing."""
    better, worse = (of["best"], value) if of["less"] else (value, of["best"])
    return max(worse, of["smallest"]) / max(better, of["smallest"])
