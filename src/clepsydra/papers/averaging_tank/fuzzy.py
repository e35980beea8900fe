"""Section 3.3 and Table 8: the Mamdani controller of volume and concentration, and Fig. 9."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clepsydra.controllers.controller import Controller
from clepsydra.controllers.fuzzy.file import FuzzyFile, WiredFuzzy, read_fuzzy
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.linearise import linearise, operating_point_of
from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.loop.run import Run
from clepsydra.papers.averaging_tank import PRINTED, fuzzy_tables
from clepsydra.papers.averaging_tank.continuous_pi import (
    HIGHEST_FLOW,
    HIGHEST_INLET,
    continuous_run,
)
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_run
from clepsydra.papers.averaging_tank.model import KMOL, high_tank
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL
from clepsydra.papers.averaging_tank.printed_tables import (
    FUZZY_INDICES,
    IAE_OF_C,
    LQI_INDICES,
    PI_INDICES,
    lower_cells,
    printed_indices,
)
from clepsydra.papers.averaging_tank.step_run import (
    MEASURED,
    PERIOD,
    STEPS,
    Settling,
    indices,
    settling,
    settling_words,
    step_of,
    step_run,
    trend_figure,
)
from clepsydra.papers.averaging_tank.symbols import C0, V0, VARIANTS
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows
from clepsydra.papers.settling_bands import BANDS
from clepsydra.process.document import parse
from clepsydra.scores.step_response import overshoot

#: The controller as a file that a user could have written.
RULES = Path(__file__).with_name("averaging-tank-fuzzy.toml")
_OUTFLOW = 'moves = "outflow"\nunit = "{}"'
#: The horizon that ITAE of C fits [s]; that of the others hardly counts.
_HORIZON = 2.0
#: Of Table 8 [s]: in these digits the filter is a continuous one, however it is sampled.
_FINE = 0.1 * PERIOD
#: In this time the slowest of the steps of C settles, without the rules (103) as well [s].
_SETTLED = 4.0
#: What settles in less than this share of another's time settles significantly sooner.
_FAR = 2.0 / 3.0
#: Ratios that differ by less are alike.
_ALIKE = 0.05


class Reading(NamedTuple):
    """What is not printed, or may be read in two ways."""

    filter_time: float = 0.0  # of both derivatives [s]
    top: str = "0.8"  # of LL in Table 3
    added_rules: bool = True  # (103)
    waiting: tuple[str, ...] = ("R25", "R26", "R27")  # those of (103) that ask for a steady V
    differentiates_step: bool = True  # the filters start at rest, and not at the first error
    outflow_unit: str = "m^3/s"  # "1" where a signal asks for a share of 1 m³/s


#: The equations as printed, and the derivative over ten of the document's steps.
LITERAL, FILTERED = Reading(), Reading(filter_time=10.0 * PERIOD)
_FROM_ERROR = FILTERED._replace(differentiates_step=False)


def run() -> Found:
    """Return the rows on fuzzy control, Fig. 9, and pictures of sets and surfaces."""
    runs = {"no filter": fuzzy_run(LITERAL), "derivatives over 2 ms": fuzzy_run(FILTERED)}
    figure = trend_figure(
        "Fig. 9", "Steps of both references under fuzzy control", runs, 1.0,
        "Inflow and outflow come to rest at 0.345 m³/s, where rules R8 and R27 put them.",
    )  # fmt: skip
    system, with_printed_top = (fuzzy_file(each).system for each in (LITERAL, Reading(top="8.0")))
    pictures = fuzzy_tables.sets_and_surfaces(system)
    tables = fuzzy_tables.tables(system, with_printed_top)
    return (*tables, *_table_8(), *claims(FILTERED), figure, *pictures)


@cache
def _model(period: float) -> LinearModel:
    """Return the linear model with three inputs, sampled with a period [s]."""
    process = dataclasses.replace(high_tank("all-inputs"), sampling_period=period)
    return linearise(find_equilibrium(process))


@cache
def fuzzy_file(reading: Reading) -> FuzzyFile:
    """Return the controller's file in a reading."""
    # Neither stands in the file: readings that differ in them alone share it, and its law.
    of_file = reading._replace(filter_time=0.0, differentiates_step=True)
    if of_file != reading:
        return fuzzy_file(of_file)
    text = RULES.read_text(encoding="utf-8")
    text = text.replace("right_shoulder = [0.6, 0.8]", f"right_shoulder = [0.6, {reading.top}]")
    text = text.replace(_OUTFLOW.format("m^3/s"), _OUTFLOW.format(reading.outflow_unit))
    if not reading.added_rules:
        text = re.sub(r"(?m)^R2[567] = .*\n", "", text)
    for rule in set(LITERAL.waiting).difference(reading.waiting):
        text = re.sub(rf"(?m)^({rule} = .*) and e_V is ZO and de_V is ZO", r"\1", text)
    return read_fuzzy(parse(text.encode(), RULES.name, "fuzzy"))


@cache
def fuzzy_run(
    reading: Reading,
    sizes: tuple[float, float] = (STEPS["C"], STEPS["V"]),
    horizon: float = _HORIZON,
    period: float = PERIOD,
) -> Run:
    """Return steps of C [kmol/m³] and V [m³] at the first sample, from the equilibrium."""
    controller, model = fuzzy_loop(reading, period)
    if not reading.differentiates_step:
        first = {
            f"de_{o}.filtered": size * MEASURED[o][1] for o, size in zip(STEPS, sizes, strict=True)
        }
        state = controller.initial_state | first
        controller = dataclasses.replace(controller, initial_state=state)
    return step_run(controller, model, sizes, horizon)


@cache
def fuzzy_loop(reading: Reading, period: float) -> tuple[Controller, LinearModel]:
    """Return the controller and the model of its tank, sampled with a period [s]."""
    model = _model(period)
    return fuzzy_controller(reading, operating_point_of(model)), model


def fuzzy_controller(reading: Reading, point: OperatingPoint) -> Controller:
    """Return the controller in a reading, for a tank whose three inputs are moved.

    The document's controller does not wait for a bumpless start: nothing is added to its outputs.
    """
    controller = WiredFuzzy(fuzzy_file(reading), point.process).controller(point, "fuzzy")
    times = {
        name: reading.filter_time for name in controller.values if name.endswith(".filter_time")
    }
    offsets = {n: 0.0 for n in controller.initial_state if n.endswith(".offset")}
    return dataclasses.replace(
        controller,
        values=controller.values | times,
        initial_state=controller.initial_state | offsets,
    )


def _rate(found: Run, name: str) -> float:
    """Return the largest change of an input from sample to sample [its unit/s]."""
    return float(np.abs(np.diff(found.values[name])).max() / (found.time[1] - found.time[0]))


def _table_8() -> Rows:
    filtered, sampled = (indices(fuzzy_run(FILTERED, period=each)) for each in (_FINE, PERIOD))
    from_error = indices(fuzzy_run(_FROM_ERROR, period=_FINE))
    printed = printed_indices("Table 8")
    # An error of at most the step takes IAE/step at least to make an IAE.
    most = (2.0 * STEPS["C"] * printed["ITAE", "C"]) ** 0.5
    evidence = [
        ("IAE is |IE| where nothing overshoots", abs(IAE_OF_C / printed["IE", "C"] - 1.0) < 0.01),
        ("ITAE allows no larger one", IAE_OF_C < most < printed["IAE", "C"]),
    ]
    for index, output in printed:
        line = PRINTED["Table 8", f"{index} of {output}"].told(
            sampled=sampled[index, output],
            most=most,
            from_error=from_error[index, output],
            met=100.0 * abs(filtered[index, output] / IAE_OF_C - 1.0),
        )
        is_exponent = (index, output) == ("IAE", "C")
        row = line.compared(
            filtered[index, output],
            right_if=evidence if is_exponent else (),
        )
        if row.verdict == "misprint":
            row = dataclasses.replace(row, reason=line.note)
        yield row.circular("Filter and horizon were chosen by the cells of this table.")


def claims(reading: Reading) -> Rows:
    """Judge what sections 3.3 to 5 say of the runs, in a reading."""
    yield from _behaviour(reading)
    yield from _rest(reading)


def _behaviour(reading: Reading) -> Rows:
    found, finer = fuzzy_run(reading), fuzzy_run(reading, period=0.5 * PERIOD)
    free, limited = (continuous_run(OPTIMAL["outflow"], free=each) for each in (True, False))
    others: dict[str, Settling] = {
        "PI by hand": continuous_run(BY_HAND["outflow"]).settling,
        "PI (81), C_in free": free.settling,
        "PI (81), C_in to 25 kmol/m³": limited.settling,
        "LQI by hand": partial(settling, lqi_run(COLUMNS[0])),
        "LQI optimal": partial(settling, lqi_run(COLUMNS[1])),
    }
    of_lqi = [partial(settling, lqi_run(each)) for each in COLUMNS]

    def fastest(output: str, band: float) -> float:
        return min(each(output, band) for each in of_lqi)

    settles = partial(settling, found)
    near, far = ({who: each("C", band) for who, each in others.items()} for band in BANDS)
    over, less = ({o: overshoot(*step_of(each, o)) for o in ("C", "V")} for each in (found, finer))
    inputs = moved(found, "inflow", "outflow", "inflow.impurity")
    f_in, f_out, c_in = ((float(values.min()), float(values.max())) for values in inputs.values())
    below_lqi, below_pi = (lower_cells(FUZZY_INDICES, each) for each in (LQI_INDICES, PI_INDICES))
    told = "; ".join(f"{who} {time:.2f} s" for who, time in near.items())
    yield PRINTED["section 4", "overshoot, fuzzy"].claimed(
        max(over.values()) < 0.1 and max(less.values()) < 1e-3 * max(over.values()),
        f"C {over['C']:.2g} %, V {over['V']:.2g} % of the step, sampled every 0.2 ms",
        **less,
    )
    yield PRINTED["section 4", "C, fuzzy against the others"].remark(
        f"settles in {settles('C', BANDS[0]):.3f} s; {told}",
        wider=settles("C", BANDS[1]),
        next=min(far.values()),
        fuzzy=_arrival(found.time, found.true_measurement("concentration") / KMOL),
        free=_arrival(free.time, free.outputs["C"]),
        limited=_arrival(limited.time, limited.outputs["C"]),
        over_free=free.overshoot("C"),
        over_limited=limited.overshoot("C"),
    )
    yield PRINTED["section 4", "settling times, fuzzy against LQI"].claimed(
        all(settles(o, b) < _FAR * fastest(o, b) for o in STEPS for b in BANDS),
        "; ".join(f"{o} {settling_words(o, settles, fastest)}" for o in STEPS),
    )
    flows, inlets = (farthest_centres(fuzzy_file(reading), o) for o in ("f_in", "C_in"))
    as_printed = farthest_centres(fuzzy_file(reading._replace(top="8.0")), "f_in")
    yield PRINTED["section 4", "control values, fuzzy"].claimed(
        min(flows[0], as_printed[0], inlets[0]) > 0.0
        and max(flows[1], as_printed[1]) < HIGHEST_FLOW
        and inlets[1] < HIGHEST_INLET,
        f"f_in {f_in[0]:.2f} to {f_in[1]:.2f}, f_out {f_out[0]:.2f} to {f_out[1]:.2f} m³/s, C_in "
        f"{c_in[0]:.1f} to {c_in[1]:.1f} kmol/m³",
        flow=f"{flows[0]:.3f} to {flows[1]:.3f}",
        printed=f"{as_printed[0]:.3f} to {as_printed[1]:.3f}",
        inlet=f"{inlets[0]:.2f} to {inlets[1]:.1f}",
    )
    yield PRINTED["section 4", "margin, fuzzy"].remark(
        f"fuzzy {100.0 * least_margin(inputs):.2g} %; {'; '.join(_other_margins())}"
    )
    other = fuzzy_run(reading._replace(differentiates_step=False))
    of_flow, of_inlet = _rate(found, "inflow"), _rate(found, "inflow.impurity")
    yield PRINTED["section 4", "change rates, fuzzy"].remark(
        f"f_in about {round(of_flow, -1):.0f} m³/s², C_in about {of_inlet / KMOL:.0e} kmol/(m³ s)",
        faster=_rate(finer, "inflow") / of_flow,
        inlet=_rate(finer, "inflow.impurity") / of_inlet,
        from_error=_rate(other, "inflow") / of_flow,
    )
    yield PRINTED["section 4", "indices, fuzzy against LQI"].claimed(
        len(below_lqi) == len(LQI_INDICES), f"{len(below_lqi)} of {len(LQI_INDICES)} cells"
    )
    line = PRINTED["section 4", "indices, fuzzy against all"].told(lower=", ".join(below_pi))
    yield line.remark(f"Table 6 is lower in {', '.join(lower_cells(PI_INDICES, FUZZY_INDICES))}")


def farthest_centres(file: FuzzyFile, output: str) -> tuple[float, float]:
    """Return the lowest and the highest centre of gravity that rules can give an output.

    They are those of its outermost sets at full height: a lower height and any other set draw it
    inwards.
    """
    (variable,) = (each for each in file.system.outputs if each.name == output)
    points = np.linspace(variable.low, variable.high, file.system.points)
    centres = [float(points @ d / d.sum()) for d in variable.degrees(points).values()]
    return min(centres), max(centres)


def _arrival(time: np.ndarray, concentration: np.ndarray) -> float:
    """Return when C [kmol/m³] first comes within 2 % of the document's step [s]."""
    return float(time[np.argmax(concentration >= C0 + 0.98 * STEPS["C"])])


def moved(run: Run, *names: str) -> dict[str, np.ndarray]:
    """Return inputs [m³/s, kmol/m³] by name."""
    return {name: run.values[name] / (KMOL if "impurity" in name else 1.0) for name in names}


def least_margin(inputs: Mapping[str, np.ndarray]) -> float:
    """Return how near inputs come to a limit of theirs, the nearest of all [share of its range]."""
    highest = {name: HIGHEST_INLET if "impurity" in name else HIGHEST_FLOW for name in inputs}
    return min(
        float(np.minimum(values, highest[name] - values).min()) / highest[name]
        for name, values in inputs.items()
    )


def _other_margins() -> Iterator[str]:
    """Return the least margins of PI control and LQI, of the inputs that they move, in words."""
    for constants in (each[variant] for variant in VARIANTS for each in (BY_HAND, OPTIMAL)):
        run = continuous_run(constants)
        margin = least_margin({"flow": run.flow, "inflow.impurity": run.inlet})
        yield f"PI, {constants.title} {100.0 * margin:.2g} %"
    for weights in COLUMNS:
        flow = "inflow" if weights.constant == "outflow" else "outflow"
        margin = least_margin(moved(lqi_run(weights), flow, "inflow.impurity"))
        yield f"LQI, {weights.title} {100.0 * margin:.2g} %"


def _rest(reading: Reading) -> Rows:
    """Judge what rules (103) do to the settling of C, and to V."""
    plain = reading._replace(added_rules=False)
    steps = {"positive": STEPS["C"], "negative": -STEPS["C"]}
    turned = {
        words: [
            partial(settling, fuzzy_run(each, (size, 0.0), _SETTLED), size=size)
            for each in (reading, plain)
        ]
        for words, size in steps.items()
    }
    reduced, ratios = [], []
    for band in BANDS:
        both = [[each("C", band) for each in pair] for pair in turned.values()]
        reduced.append([without - with_rules for with_rules, without in both])
        ratios += [without / with_rules for with_rules, without in both]
    assert max(ratios) / min(ratios) - 1.0 < _ALIKE
    (up, down), _ = reduced
    yield PRINTED["section 3.3", "rules (103)"].claimed(
        all(0.0 < upwards < downwards for upwards, downwards in reduced),
        "; ".join(f"{settling_words('C', *both)} ({words} step)" for words, both in turned.items()),
        up=up,
        down=down,
        ratio=sum(ratios) / len(ratios),
    )
    alone = (fuzzy_run(reading, (size, 0.0), _SETTLED) for size in steps.values())
    off = max(float(np.abs(run.true_measurement("volume") - V0).max()) for run in alone)
    yield PRINTED["section 3.3", "constant V"].claimed(off < 1e-9, f"V within {off:.1g} m³")
    yield _premise(reading)


def _premise(reading: Reading) -> Row:
    """Judge that the rules (103) ask for a steady V, by those that do not."""
    without = {
        "without it": reading._replace(waiting=()),
        "without it in R25 and R26": reading._replace(waiting=("R27",)),
    }
    both = {"up": (STEPS["C"], STEPS["V"]), "down": (-STEPS["C"], -STEPS["V"])}

    def times(each: Reading, band: float) -> list[float]:
        return [
            settling(fuzzy_run(each, sizes), "V", band, size=sizes[1]) for sizes in both.values()
        ]

    told, is_later = [], []
    for band in BANDS:
        as_printed = times(reading, band)
        later = {words: times(each, band) for words, each in without.items()}
        is_later += [max(as_printed) < min(each) for each in later.values()]
        shown = "; ".join(
            f"{words} {' and '.join(f'{each:.2f}' for each in found)} s"
            for words, found in {"with it": as_printed, **later}.items()
        )
        told.append(f"to within {100 * band:g} %: {shown}")
    return PRINTED["section 3.3", "premise of rules (103)"].claimed(
        all(is_later), f"{' and '.join(both)}, {'; '.join(told)}"
    )
