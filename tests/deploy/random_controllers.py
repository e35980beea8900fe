"""Random controllers: own laws of expressions, PID, schemes of blocks, linear laws, in a shell.

As in `random_programs`, what is drawn is the Python text that makes the program.
"""

from dataclasses import replace

from hypothesis import strategies as st
from plants import designed
from random_programs import IMPORTS, Written, modest, numbers

from clepsydra import PidForm, Signal, StepLaw
from clepsydra.base.signal import path
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock

LAW_IMPORTS = (
    IMPORTS
    + """\
from clepsydra import PidForm
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import with_plant_shell
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock
from own_laws import law_of
from plants import designed
"""
)
RANGES = ((0.0, 10.0), (-1.0, 1.0), (0.004, 0.02), (0.0, 100.0), (1e5, 3e5))
UNITS = ("m", "V", "1", "l/s", "mol/m^3", "A", "furlong")
DESCRIPTIONS = (
    "", "level of tank 1", "a */ comment (* that */ closes *)", 'says "less" < & > more',
    "Füllstand",
    "two\nlines\tand a tab", "ends in a backslash \\", "what?" + "?/ a trigraph", "$N, $$ and 'q'",
    "{pragma} // and more", "]]> --",
)  # fmt: skip
PERIODS = (1.0, 0.1, 1 / 3, 60.0, 0.004)


@st.composite
def _range(draw) -> tuple[float, float]:
    return draw(st.sampled_from(RANGES))


@st.composite
def process_signals(draw, prefix: str, count: int) -> list[Signal]:
    """Signals of a process, with ranges, units and descriptions that want care in a text."""
    found = []
    for number in range(1, count + 1):
        low, high = draw(_range())
        found.append(
            Signal(
                f"{prefix}_{number}",
                draw(st.sampled_from(UNITS)),
                low=low,
                high=high,
                initial=draw(st.sampled_from([low, high, (low + high) / 2])),
                description=draw(st.sampled_from(DESCRIPTIONS)),
            )
        )
    return found


# ------------------------------------------------------------------ laws of expressions


class _Expressions:
    """Random expressions of CasADi over named scalars, a line each."""

    UNARY = (
        "-{0}", "ca.fabs({0})", "ca.sqrt(ca.fabs({0}))", "ca.floor({0})", "ca.ceil({0})",
        "ca.sign({0})", "{0}**2", "2 * {0}", "1 / {0}", "ca.sqrt({0})", "ca.logic_not({0})",
    )  # fmt: skip
    BINARY = (
        "{0} + {1}", "{0} - {1}", "{0} * {1}", "{0} / {1}", "ca.fmin({0}, {1})",
        "ca.fmax({0}, {1})", "ca.if_else({0} < {1}, {0}, {1})", "({0} < {1})", "({0} <= {1})",
        "({0} == {1})", "({0} != {1})", "ca.logic_and({0} > 0, {1} > 0)",
        "ca.logic_or({0} > 0.5, {1} < 0)",
        "ca.if_else(ca.logic_not(ca.fabs({0}) <= 1e300), {1}, {0})",
        "ca.if_else({0}, ca.if_else({1}, {0}, {1}), ca.if_else({0} > {1}, {1}, -{0}))",
    )  # fmt: skip

    def __init__(self, draw, known: list[str]) -> None:
        self.draw, self.known, self.lines = draw, known, []

    def more(self, most: int) -> None:
        for number in range(1, self.draw(st.integers(1, most)) + 1):
            name = f"v{number}"
            self.lines.append(f"{name} = {self._one(number)}")
            self.known.append(name)

    def _one(self, number: int) -> str:
        what = self.draw(st.integers(0, 9))
        if what == 9:
            return self._loop(number)
        if what > 6:
            form = self.draw(st.sampled_from(self.UNARY))
        else:
            form = self.draw(st.sampled_from(self.BINARY))
        return form.format(self.operand(), self.operand())

    def operand(self) -> str:
        if self.draw(st.integers(0, 3)) == 3:
            return f"ca.SX({self.draw(numbers)!r})"
        # The latest ones first, so that chains arise.
        return self.draw(st.sampled_from(self.known[::-1]))

    def _loop(self, number: int) -> str:
        """A counted loop over a table; the body may leave out any of what it is given."""
        count = self.draw(st.sampled_from([1, 2, 4]))
        table = [self.draw(modest) for _ in range(count)]
        row, total, given = (f"{name}{number}" for name in ("row", "total", "given"))
        body = self.draw(
            st.sampled_from(
                (
                    "{total} + {row}", "{total} * {given} + {row}", "ca.fmin({total}, {given})",
                    "ca.if_else({row} > {given}, {total} + 1, {total})", "{total}", "-{given}",
                )
            )
        ).format(row=row, total=total, given=given)  # fmt: skip
        self.lines += [
            f'{row}, {total}, {given} = (ca.SX.sym(n) for n in ("row", "total", "given"))',
            f'body{number} = ca.Function("body{number}", [{row}, {total}, {given}], [{body}])',
        ]
        return (
            f'counted_loop("turns{number}", {count}, body{number}, tables=[{table!r}], '
            f"carried=ca.SX({self.operand()}), invariants=ca.SX({self.operand()}))"
        )

    def kept_within(self, low: float, high: float) -> str:
        """What a state becomes: within bounds at times, so that not all ends as no number."""
        value = self.draw(st.sampled_from(self.known[::-1]))
        return self.draw(
            st.sampled_from([f"ca.fmin(ca.fmax({value}, {low}), {high})", f"ca.SX({value})"])
        )


@st.composite
def own_laws(draw) -> Written:
    """A law as a user writes one, behind the output stage that is added and in its shell.

    States, rings, inputs that nobody reads, outputs that are inputs, and no state at all.
    """
    measured, setpoints, moved = (
        [replace(s, name=path(s, part)) for s in draw(process_signals(name, draw(count)))]
        for name, part, count in (
            ("measured", "pv", st.integers(1, 2)),
            ("followed", "sp", st.integers(0, 2)),
            ("moved", "out", st.integers(1, 2)),
        )
    )
    inputs = [*setpoints, *measured]
    if draw(st.booleans()):
        inputs.append(Signal("time_step", "s", low=0.0, initial=1.0))
    inputs += [Signal(path(s.owner, "last_output"), s.unit) for s in moved if draw(st.booleans())]
    gains = [Signal(f"gain_{k}", initial=draw(modest)) for k in range(draw(st.integers(0, 3)))]
    if draw(st.booleans()):
        gains.append(Signal("chosen", low=0.0, high=1.0, initial=1.0, kind="boolean"))
    if draw(st.booleans()):
        gains.append(Signal("count_to", low=0.0, high=9.0, initial=3.0, kind="integer"))
    state = [
        f"Signal('memory_{k}', initial={draw(modest)!r})" for k in range(draw(st.integers(0, 3)))
    ]
    names = [f"memory_{k}" for k in range(len(state))]
    if draw(st.booleans()):
        state.append(f"DelayRing(Signal('late', initial=0.5), {draw(st.sampled_from([1, 2, 5]))})")
        names.append("late")
    known = [f's["{name}"]' for name in [*names, *(g.name for g in (*inputs, *gains))]]
    text = _Expressions(draw, known)
    text.more(10)
    following = {name: text.kept_within(-10.0, 10.0) for name in names}
    outputs = {s.name: draw(st.sampled_from(text.known[::-1])) for s in moved}
    named = {
        f"inner_{k}": draw(st.sampled_from(text.known)) for k in range(draw(st.integers(0, 2)))
    }
    limits = {}
    for signal in moved:
        ends = (path(signal.owner, f"{end}_limit") for end in ("low", "high"))
        limits |= dict(zip(ends, (signal.low, signal.high), strict=True))
    law = "\n".join(
        [
            'law = law_of(r"""',
            "import casadi as ca",
            "from math import inf",
            "from clepsydra import Signal",
            "from clepsydra.program.counted_loop import counted_loop",
            "from clepsydra.program.delay_ring import DelayRing",
            "from clepsydra.program.step_law import Equations, step_law",
            "",
            "def equations(s):",
            *(f"    {line}" for line in text.lines),
            f"    return Equations({_mapping(following)}, {_mapping(outputs)}, {_mapping(named)})",
            "",
            f"inputs = {_listed(inputs)}",
            f"parameters = {_listed(gains)}",
            f"state = [{', '.join(state)}]",
            f"outputs = {_listed(moved)}",
            'law = step_law("own_law", inputs=inputs, parameters=parameters, state=state,',
            "               outputs=outputs, equations=equations)",
            '""")',
        ]
    )
    counts = len(measured), len(setpoints), len(moved)
    return draw(_shelled(law, counts, limits))


def _mapping(entries: dict[str, str]) -> str:
    return "{" + ", ".join(f"{name!r}: {value}" for name, value in entries.items()) + "}"


def _listed(signals: list[Signal]) -> str:
    return "[" + "".join(f"\n    {signal!r}," for signal in signals) + "\n]"


# ------------------------------------------------------------------ controllers in their shell


@st.composite
def _shelled(
    draw, law: str, counts: tuple[int, int, int], values: dict[str, float], clamps: bool = False
) -> Written:
    """Put a law into a controller, bare or in its shell with random settings.

    `counts` says how many measurements, setpoints and outputs there are. The shell limits no rate
    of a law that clamps.
    """
    period = draw(st.sampled_from(PERIODS))
    names = [
        [f"{what}{k}" for k in range(count)] for what, count in zip("yru", counts, strict=True)
    ]
    settings = {}
    for what, group, choices in (
        ("sensor_delay", names[0], (0.0, 4.0, 0.5, 1e3)),
        ("setpoint_rate", names[1], (0.1, 1e-3, 1e6)),
        ("rate_limit", names[2], (0.5, 1e-3, 1e6)),
    ):
        chosen = {name: draw(st.sampled_from(choices)) for name in group if draw(st.booleans())}
        if chosen and not (clamps and what == "rate_limit"):
            settings[what] = chosen
    shell = ", ".join(f"{what}={value!r}" for what, value in settings.items())
    bare = draw(st.integers(0, 4)) == 4
    lines = [
        # Remote setpoints and their choice.
        'wired = "sp", "pv", "good", "mode", "manual", "tracking", "time_step"',
        "free = {s.name: s.initial for s in law.inputs if s.part not in wired}",
        f"values = {{p.name: p.initial for p in law.parameters}} | {values!r}",
        "start = {e.name: getattr(e, 'signal', e).initial for e in law.state}",
        f"names = {tuple(map(tuple, names))!r}",
        'controller = Controller("random", "random", "", law, values, start, *names, (), free)',
        f"period = {period!r}",
        "program = controller.program()"
        if bare
        else f"program = with_plant_shell(controller, period, PlantShell({shell})).program()",
    ]
    return Written(f"{LAW_IMPORTS}\n{law}\n" + "\n".join(lines) + "\n", period=period)


@st.composite
def _values_of(draw, law: StepLaw) -> dict[str, float]:
    """A value for every parameter: mostly reasonable, at times at the end of its range or zero."""
    found = {}
    for parameter in law.parameters:
        ends = ("low_limit", "high_limit", "lowest_ratio", "highest_ratio")
        if (
            parameter.part in ends
            or parameter.owner.startswith("split.")
            or parameter.kind != "real"
        ):
            continue
        choices = [1.0, 0.3, -0.7, 31.0, 1 / 3, 1e-6, 0.0, -0.0, 1e9, 1e-300, 123.456789]
        fitting = [x for x in choices if parameter.low <= x <= parameter.high]
        found[parameter.name] = draw(st.sampled_from(fitting))
    return found


@st.composite
def forms(draw, selected: bool = False) -> PidForm:
    """Every form of PID control that there is."""
    algorithm = draw(st.sampled_from(["isa", "series", "parallel", "velocity"]))
    actions = draw(st.sampled_from(["PI", "PID"] if algorithm == "velocity" else
                                   ["PI", "P", "PD", "PID"]))  # fmt: skip
    winding = ["back_calculation"]
    if not selected:
        winding += ["conditional_integration", "clamping", "none"]
    shapes = ["linear"] + (["gap", "squared"] if algorithm in ("isa", "parallel") else [])
    return PidForm(
        actions,
        algorithm,
        draw(st.sampled_from(["measurement", "error"])),
        draw(st.sampled_from(shapes)),
        draw(st.sampled_from(winding)),
        draw(st.booleans()),
        draw(st.booleans()),
    )


@st.composite
def pid_controllers(draw) -> Written:
    """One to three loops, each form, rate limits, decoupling."""
    loops = draw(st.integers(1, 3))
    form = draw(forms())
    measured = draw(process_signals("level", loops))
    moved = draw(process_signals("pump", loops))
    options = {
        "rate_limited": draw(st.booleans()),
        "decoupling": draw(st.sampled_from([None, "static", "dynamic"])) if loops > 1 else None,
    }
    law = multiloop_pid_law(measured, moved, form, **options)
    written = ", ".join(f"{name}={value!r}" for name, value in options.items())
    text = (
        f"measured = {_listed(measured)}\nmoved = {_listed(moved)}\n"
        f"form = {form!r}\n"
        f"law = multiloop_pid_law(measured, moved, form, {written})"
    )
    clamps = form.anti_windup == "clamping"
    return draw(_shelled(text, (loops, loops, loops), draw(_values_of(law)), clamps))


# ------------------------------------------------------------------ schemes of blocks


class _Scheme:
    """Blocks of a control scheme, drawn from the outputs back to the setpoints."""

    def __init__(self, draw) -> None:
        self.draw = draw
        self.blocks: list = []
        self.measured: list[Signal] = []
        self.setpoints: dict[str, Signal] = {}
        self._count = 0

    def outputs(self) -> None:
        if self.draw(st.integers(0, 2)) == 2:
            span = Signal("span", "%", low=0.0, high=100.0)
            source = self.giver(span, 2, selected=False)
            pumps = self.draw(process_signals("moved", 2))
            middle = self.draw(st.sampled_from([50.0, 30.0]))
            gap = self.draw(st.sampled_from([0.0, 20.0]))
            parts = ((0.0, middle), (middle + gap, 100.0))
            legs = tuple(
                Leg(f"split.{pump.name}", pump, *part, *self.draw(st.sampled_from(
                    [(pump.low, pump.high), (pump.high, pump.low)]
                )))
                for pump, part in zip(pumps, parts, strict=True)
            )  # fmt: skip
            self.blocks.append(SplitRangeBlock("split", source, legs))
            for leg in legs:
                self.blocks.append(
                    OutputBlock(leg.moved, leg.port("split"), self.draw(st.booleans()))
                )
            self.moved = pumps
            return
        self.moved = self.draw(process_signals("moved", self.draw(st.integers(1, 2))))
        for signal in self.moved:
            source = self.giver(signal, 2, selected=False, direct=True)
            self.blocks.append(OutputBlock(signal, source, self.draw(st.booleans())))

    def _name(self) -> str:
        self._count += 1
        return f"block {self._count}"

    def _measurement(self) -> Signal:
        (signal,) = self.draw(process_signals("seen", 1))
        signal = replace(signal, name=f"seen_{len(self.measured) + 1}")
        self.measured.append(signal)
        return signal

    def giver(self, moved: Signal, depth: int, *, selected: bool, direct: bool = False) -> str:
        """Append a block that moves a signal, and return its name."""
        kinds = ["pid", "pid"] + (["selector", "feedforward", "ratio", "trimmed"] if depth else [])
        kind, name = self.draw(st.sampled_from(kinds)), self._name()
        own = self._count
        if kind == "selector":
            count = self.draw(st.integers(2, 3))
            sources = tuple(self.giver(moved, depth - 1, selected=True) for _ in range(count))
            block = SelectorBlock(name, sources, self.draw(st.sampled_from(["low", "high"])))
        elif kind == "feedforward":
            source = self.giver(moved, depth - 1, selected=selected)
            terms = []
            for k in range(self.draw(st.integers(1, 2))):
                owner, signal, dynamic = f"ahead_{own}.{k}", self._measurement(), st.booleans()
                terms.append(FeedforwardTerm(owner, moved, signal, True, self.draw(dynamic)))
            block = FeedforwardBlock(name, source, moved, tuple(terms))
        elif kind in ("ratio", "trimmed"):
            wild = self._measurement()
            share = Signal("share", low=0.0, high=10.0)
            source = None
            if kind == "trimmed":
                source = self.giver(share, depth - 1, selected=selected)
            block = RatioBlock(name, f"ratio_{own}", wild, moved, source)
        else:
            block = self._pid(name, moved, depth, selected, direct)
        self.blocks.append(block)
        return name

    def _pid(self, name: str, moved: Signal, depth: int, selected: bool, direct: bool) -> PidBlock:
        owner, signal = f"loop_{self._count}", self._measurement()
        form = self.draw(forms(selected))
        inner = bool(depth and self.draw(st.integers(0, 2)) == 2)
        if inner:
            setpoint = self.giver(signal, depth - 1, selected=selected)
        else:
            self.setpoints[signal.name], setpoint = signal, f"{signal.name}.sp"
        return PidBlock(name, owner, form, signal, moved, setpoint, inner, direct)


@st.composite
def schemes(draw) -> Written:
    """Cascades, selectors, split ranges, ratios and feedforward, one inside another."""
    scheme = _Scheme(draw)
    scheme.outputs()
    law = structure_law(
        "scheme", scheme.blocks, setpoints=scheme.setpoints, measured=scheme.measured
    )
    blocks = "".join(f"\n    {block!r}," for block in scheme.blocks)
    text = (
        f"blocks = [{blocks}\n]\nsetpoints = {scheme.setpoints!r}\n"
        f"measured = {_listed(scheme.measured)}\n"
        'law = structure_law("scheme", blocks, setpoints=setpoints, measured=measured)'
    )
    values = draw(_values_of(law))
    loops = [block for block in scheme.blocks if isinstance(block, PidBlock)]
    clamps = any(block.form.anti_windup == "clamping" for block in loops)
    counts = len(scheme.measured), len(scheme.setpoints), len(scheme.moved)
    return draw(_shelled(text, counts, values, clamps))


# ------------------------------------------------------------------ linear laws


#: LQI, state feedback, and a linear law that is told what was applied, as designs make them.
LINEAR = (
    *(
        ("lqi", name, {"anti_windup": winding})
        for name in ("equalisation-tank", "three-tanks", "quadruple-tank")
        for winding in ("back_calculation", "conditional_integration", "none")
    ),
    *(
        ("lqr", name, {})
        for name in ("equalisation-tank", "three-tanks", "quadruple-tank", "wet-well")
    ),
    *(
        ("glover_mcfarlane", name, {"order": order})
        for name, order in (("equalisation-tank", 1), ("three-tanks", 3), ("quadruple-tank", 4))
    ),
)


@st.composite
def linear_laws(draw) -> Written:
    """A linear law of a design with other numbers."""
    design, name, options = draw(st.sampled_from(LINEAR))
    made = designed(design, name, **options)
    counts = len(made.measurements), len(made.setpoints), len(made.manipulated)
    text = f"law = designed({design!r}, {name!r}, **{options!r}).law"
    return draw(_shelled(text, counts, draw(_values_of(made.law))))


CONTROLLERS = {
    "own law": own_laws,
    "PID": pid_controllers,
    "scheme": schemes,
    "linear": linear_laws,
}
