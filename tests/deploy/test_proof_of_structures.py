"""Engine, C and Structured Text of every PID and of a scheme of all blocks, equal in every bit.

And the C divides by zero nowhere, whatever the settings: it runs under the compiler's own check.
"""

import math
import subprocess

import numpy as np
import pytest
from deployed import no_output_lay_idle, run_alike, spoilt
from tools import need_compiler

from clepsydra import PidForm, Signal, program_of
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock
from clepsydra.deploy.c99.printer import print_c
from clepsydra.program.defaults import with_defaults
from clepsydra.program.entries import signal_of

SCANS = 2_000
HELD = 20

FORMS = {
    "isa": PidForm("PID"),
    "isa-on-error": PidForm("PID", derivative_on="error", anti_windup="conditional_integration"),
    "isa-gap": PidForm("PID", error="gap", anti_windup="clamping"),
    "isa-squared": PidForm("PI", error="squared", anti_windup="none"),
    "isa-P": PidForm("P"),
    "series": PidForm("PID", "series", setpoint_ramp=True),
    "series-on-error": PidForm("PID", "series", "error", anti_windup="clamping"),
    "parallel": PidForm("PID", "parallel", remote_setpoint=True),
    "parallel-PD": PidForm("PD", "parallel", "error", setpoint_ramp=True, remote_setpoint=True),
    "velocity": PidForm("PID", "velocity", remote_setpoint=True),
    "velocity-on-error": PidForm("PID", "velocity", "error", setpoint_ramp=True),
}

LEVEL, FLOW = Signal("level", "m", low=0.0, high=10.0), Signal("flow", "l/s", low=0.0, high=10.0)
FEED, STRENGTH = Signal("feed", "l/s", low=0.0, high=10.0), Signal("strength", low=0.0, high=10.0)
PUMP, VALVE = Signal("pump", "%", low=0.0, high=100.0), Signal("valve", "%", low=0.0, high=100.0)
DOSE, SHARE = Signal("dose", "l/s", low=0.0, high=50.0), Signal("share", low=0.0, high=5.0)
RANGE = Signal("range", "%", low=0.0, high=100.0)


def scheme_of_all_blocks():
    """A level and a strength override each other; what is selected, with feedforward from the
    feed, is the setpoint of a flow, which moves pump and valve by a split range; a strength
    trims the ratio of the dose to the feed."""
    selected = PidForm("PID", "isa")
    blocks = [
        PidBlock("level_loop", "level", selected, LEVEL, FLOW, "level.sp", direct=False),
        PidBlock(
            "strength_loop",
            "strength",
            PidForm("PI", "velocity"),
            STRENGTH,
            FLOW,
            "strength.sp",
            direct=False,
        ),
        SelectorBlock("selected", ("level_loop", "strength_loop"), "low"),
        FeedforwardBlock(
            "sum",
            "selected",
            FLOW,
            (
                FeedforwardTerm("feed_ahead", FLOW, FEED, measured=True, dynamic=True),
                FeedforwardTerm("dose_ahead", FLOW, DOSE, measured=False, dynamic=False),
            ),
        ),
        PidBlock(
            "flow_loop",
            "flow",
            PidForm("PI", "series"),
            FLOW,
            RANGE,
            "sum",
            inner=True,
            direct=False,
        ),
        SplitRangeBlock(
            "split",
            "flow_loop",
            (
                Leg("split.pump", PUMP, 0, 45, 10, 90),
                Leg("split.valve", VALVE, 55, 100, 0, 100),
            ),
        ),
        OutputBlock(PUMP, "split, pump", True),
        OutputBlock(VALVE, "split, valve"),
        PidBlock(
            "trim", "trim", PidForm("PID", "parallel"), STRENGTH, SHARE, "trim.sp", direct=False
        ),
        RatioBlock("proportion", "proportion", FEED, DOSE, "trim"),
        OutputBlock(DOSE, "proportion"),
    ]
    return structure_law(
        "all_blocks",
        blocks,
        setpoints={"level": LEVEL, "strength": STRENGTH, "trim": STRENGTH},
        measured=[LEVEL, FLOW, FEED, STRENGTH],
    )


def scans(program, seed):
    """A plant that goes wrong in every way that the inputs can express."""
    random = np.random.default_rng(seed)
    choices = {
        "mode": ([0.0, 1.0, 2.0, 3.0], [0.1, 0.75, 0.1, 0.05]),
        "setpoint_source": ([0.0, 1.0, 2.0], [0.45, 0.5, 0.05]),
    }
    inputs = {}
    for signal in program.inputs:
        name = signal.name
        if signal.part in choices:
            values, chance = choices[signal.part]
            inputs[name] = np.repeat(random.choice(values, SCANS // HELD, p=chance), HELD)
        elif signal.part == "good":
            inputs[name] = (random.random(SCANS) < 0.96).astype(float)
        elif signal.part == "pv":
            walk = np.cumsum(random.normal(scale=0.2, size=SCANS))
            inputs[name] = spoilt(random, 5.0 + 4.0 * np.sin(walk), 0.02)
        elif name == "time_step":
            steps = random.choice([1.0, 0.1, 1 / 3], size=SCANS)
            inputs[name] = np.where(random.random(SCANS) < 0.97, steps, random.choice(
                [0.0, -1.0, math.nan, math.inf], size=SCANS))  # fmt: skip
        else:
            levels = np.repeat(random.uniform(1, 9, SCANS // HELD), HELD)
            inputs[name] = spoilt(random, levels, 0.01)
    return inputs


def uneven(program, seed):
    """Settings with no short binary form, none of them neutral; the gains differ from the last
    sample's, so that the first one takes up a change."""
    random = np.random.default_rng(seed)
    ranges = {
        "proportional_gain": (0.5, 3.0), "integral_gain": (0.02, 0.2), "integral_time": (5, 50),
        "derivative_gain": (0.5, 2.0), "derivative_time": (0.5, 3.0), "filter_time": (0.1, 0.5),
        "derivative_filter": (2.0, 9.0), "setpoint_weight": (0.2, 0.9), "tracking_time": (1, 30),
        "setpoint_ramp": (0.1, 0.9), "rate_limit": (5.0, 20.0), "gap": (0.1, 0.9),
        "gap_gain": (0.1, 0.9), "squared_error_scale": (0.5, 3.0), "highest_ratio": (4.0, 5.0),
        **dict.fromkeys(("gain", "reference", "lead", "lag"), (0.1, 2.0)),  # of feedforward
    }  # fmt: skip
    return {
        signal.name: float(random.uniform(*ranges[part]))
        for signal in (*program.parameters, *map(signal_of, program.state))
        if (part := signal.part.removeprefix("last_")) in ranges
    }


def program_under_test(name):
    law = scheme_of_all_blocks() if name == "scheme" else None
    if law is None:
        law = multiloop_pid_law(
            ["level_1"], ["pump_1"], FORMS[name], rate_limited=name in ("isa", "parallel")
        )
    program = program_of(law)
    limits = {"pump_1.low_limit": -2.0, "pump_1.high_limit": 11.0} if name != "scheme" else {}
    return with_defaults(program, uneven(program, len(name)) | limits)


@pytest.mark.sampled
@pytest.mark.parametrize("name", [*FORMS, "scheme"])
def test_engine_c_and_structured_text_are_equal_in_every_bit(name, tmp_path):
    program = program_under_test(name)
    inputs = scans(program, seed=len(name) + 1)
    engine = run_alike(program, tmp_path, inputs)
    # Each status bit was set and clear, and each state moved: no part of the law lay idle.
    no_output_lay_idle(program, engine, (1, 2, 16, 32, 64), 100)
    for column, entry in enumerate(program.state, start=len(program.outputs)):
        if not entry.part.startswith("last_") or entry.part == "last_output":
            assert len(np.unique(engine[:, column])) > 50, entry.name


MAIN = """
#include <stddef.h>
#include <stdio.h>
#include "{name}.h"

static {name}_parameters parameters;
static {name}_state state;
static {name}_inputs inputs;
static {name}_outputs outputs;
static double *const settings[] = {{{settings}}};
static double *const measured[] = {{{measured}}};

int main(void)
{{
    const size_t count = sizeof settings / sizeof *settings;
    const double steps[] = {{1.0, 0.1, 0.0}}, levels[] = {{4.0, 0.0, 6.0, -3.0}};
    for (size_t zero = 0; zero <= count; zero++) {{
        {name}_default_parameters(&parameters);
        {name}_initialise(&state);
        for (size_t k = 0; k < count; k++)
            if (k == zero || zero == count)
                *settings[k] = 0.0;
        for (int scan = 0; scan < 24; scan++) {{
            {steady}
            inputs.time_step = steps[scan % 3];
            for (size_t k = 0; k < sizeof measured / sizeof *measured; k++)
                *measured[k] = levels[scan % 4];
            {name}_step(&parameters, &state, &inputs, &outputs);
        }}
    }}
    printf("%zu", count);
    return 0;
}}
"""
CHECKED = ["-fsanitize=float-divide-by-zero", "-fno-sanitize-recover=float-divide-by-zero"]


@pytest.mark.parametrize(
    "name",
    ["isa", *(pytest.param(n, marks=pytest.mark.thorough) for n in [*FORMS, "scheme"][1:])],
)
def test_the_c_divides_by_zero_nowhere(name, tmp_path):
    """Each setting at zero, and all at once, under the check that the compiler builds in."""
    compiler, program = need_compiler(), program_under_test(name)
    printed = print_c(program)
    (tmp_path / printed.header_name).write_text(printed.header, encoding="utf-8")
    settings = [f"&parameters.{signal.identifier}" for signal in program.parameters]
    measured = [f"&inputs.{signal.identifier}" for signal in program.inputs if signal.part == "pv"]
    steady = ("sp", "good", "mode", "setpoint_source", "remote_setpoint")
    ones = [f"inputs.{s.identifier} = 1;" for s in program.inputs if s.part in steady]
    main = MAIN.format(
        name=program.name,
        settings=", ".join(settings),
        measured=", ".join(measured),
        steady=" ".join(ones),
    )

    def run(statement=""):
        source = main.replace("    printf(", f"    {statement}\n    printf(")
        paths = tmp_path / printed.source_name, tmp_path / "main.c"
        for path, text in zip(paths, (printed.source, source), strict=True):
            path.write_text(text, encoding="utf-8")
        target = str(tmp_path / "checked")
        command = [compiler, "-std=c99", "-O1", *CHECKED, *map(str, paths), "-lm", "-o", target]
        built = subprocess.run(command, capture_output=True, text=True)
        if built.returncode and ("sanitize" in built.stderr or "ubsan" in built.stderr):
            pytest.skip("the compiler has no check of divisions by zero")
        assert built.returncode == 0, built.stderr
        return subprocess.run([target], capture_output=True, text=True)

    found = run()
    assert found.returncode == 0, found.stderr
    assert found.stdout == str(len(program.parameters))
    # The check does see one.
    moved = program.outputs[0].identifier
    seen = run(f"{{ volatile double nothing = 0.0; outputs.{moved} = 1.0 / nothing; }}")
    assert seen.returncode != 0 and "division by zero" in seen.stderr
