"""Every control structure does on a plant what it is for, with the number it would be without."""

import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import clepsydra as cl
from clepsydra import Kernel, PidForm, Signal
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.structure.feedforward_block import FeedforwardBlock, FeedforwardTerm
from clepsydra.controllers.structure.law import structure_law
from clepsydra.controllers.structure.output_block import OutputBlock
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.controllers.structure.ratio_block import RatioBlock
from clepsydra.controllers.structure.selector_block import SelectorBlock
from clepsydra.controllers.structure.split_range_block import Leg, SplitRangeBlock
from clepsydra.linear.analysis import analyse
from clepsydra.loop.closed_loop import closed_loop, controller_name
from clepsydra.loop.loop import Loop
from clepsydra.process.reader import load_process

PI, P = PidForm(), PidForm("P")
HOUR = 3600.0


def model_of(name):
    return analyse(load_process(name)).model


def controller(model, blocks, settings, *, measured, setpoints=("level",), rest=None, free=None):
    """Join blocks to a controller that rests at the operating point."""
    process, at = model.point.process, model.point.as_dict()
    outputs = [block.name for block in blocks if isinstance(block, OutputBlock)]
    law = structure_law(
        "scheme",
        blocks,
        setpoints={name: process.signal(name) for name in setpoints},
        measured=[process.signal(name) for name in measured],
    )
    values = {parameter.name: parameter.initial for parameter in law.parameters}
    assert not set(settings) - set(values), set(settings) - set(values)
    values |= settings
    inputs = {f"{name}.sp": at[name] for name in setpoints}
    inputs |= {f"{name}.pv": at[name] for name in measured}
    inputs |= {f"{name}.tracking": (rest or at)[name] for name in outputs}
    return Controller(
        "scheme", "loop structure", "By hand.", law, values,
        state_at_rest(law, values, inputs | (free or {})),
        tuple(measured), tuple(setpoints), tuple(outputs),
        free_inputs=free or {},
    )  # fmt: skip


def pid(loop, k, ti, **more):
    settings = {"proportional_gain": k, "integral_time": ti, "tracking_time": ti}
    settings |= {"setpoint_weight": 1.0, **more}
    return {f"{loop}.{name}": value for name, value in settings.items()}


def run(controller, model, samples, parameters=None, **inputs):
    """Simulate with the kernel; a parameter that differs is a step of it at the start."""
    loop = Loop(controller, model)
    program = closed_loop(loop.process, controller, substeps=loop.substeps)
    given = {name.replace("__", "."): value for name, value in inputs.items()}
    result = Kernel(program).run(
        samples,
        inputs=loop.at_rest() | given,
        state=loop.initial_state(),
        parameters=loop.law_parameters() | (parameters or {}),
    )
    values = {signal.name: result.output(signal.name)[0] for signal in program.outputs}
    return values | {name: np.broadcast_to(v, samples) for name, v in given.items()}


def scanned(controller, model, found):
    """Scan the law again with what was recorded: its named values and its state by sample."""
    law, wires = controller.law, controller.input_wires
    rest, period = Loop(controller, model).at_rest(), model.point.process.sampling_period
    state = [controller.initial_state[entry.name] for entry in law.state]
    values = [controller.values[parameter.name] for parameter in law.parameters]
    rows = []
    for k in range(len(found["level"])):
        now = {name: found[name][k] if name in found else rest[name] for name in wires.values()}
        now["time_step"] = period
        inputs = [now[wires.get(signal.name, signal.name)] for signal in law.inputs]
        rows.append(dict(zip([x.name for x in law.state], np.array(state).ravel(), strict=True)))
        state, outputs, named = law.function(state, inputs, values)
        rows[-1] |= {s.name: float(named[i]) for i, s in enumerate(law.intermediates)}
        for i, moved in enumerate(controller.manipulated):
            assert float(outputs[2 * i]) == found[moved][k]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def travel(values):
    return float(np.abs(np.diff(values)).sum())


# The wet well with flow meters: level [A] of 4 to 20 mA over 4 m, flows [m³/s], speed [1].
PER_METRE = 0.004
GAIN = 0.0736  # of the pump at the operating point [m³/s]
LEVEL_GAIN = -12.0 / PER_METRE / 60.0  # a closed-loop time of 60 s in a well of 12 m²


@pytest.fixture(scope="module")
def well():
    model = model_of("wet-well:flow-meters")
    process = model.point.process
    return SimpleNamespace(
        model=model,
        level=process.signal("level"),
        flow=process.signal("duty_flow"),
        inflow=process.signal("inflow_meter"),
        duty=process.signal("duty"),
        low=model.point.as_dict()["well.level"],
    )


def single(well):
    loop = PidBlock.of(well.level, PI, well.duty)
    return controller(
        well.model, [loop, OutputBlock(well.duty, loop.name)],
        pid("level", LEVEL_GAIN / GAIN, 240.0), measured=["level"],
    )  # fmt: skip


def cascade(well, feedforward=False, form=PI):
    """Level to flow to speed; with feedforward the measured inflow is added to the flow."""
    outer = PidBlock.of(well.level, form, well.flow, direct=False)
    source = "sum" if feedforward else outer.name
    inner = PidBlock("flow", "flow", form, well.flow, well.duty, source, inner=True)
    blocks = [outer, inner, OutputBlock(well.duty, "flow")]
    settings = pid("level", LEVEL_GAIN, 240.0) | pid("flow", 0.4 / GAIN, 4.0)
    if form.winding != "back_calculation":
        settings = {k: v for k, v in settings.items() if "tracking" not in k}
    measured = ["level", "duty_flow"]
    at = well.model.point.as_dict()
    if feedforward:
        term = FeedforwardTerm("ahead", well.flow, well.inflow, measured=True, dynamic=False)
        blocks.append(FeedforwardBlock("sum", outer.name, well.flow, (term,)))
        settings |= {"ahead.gain": 1.0, "ahead.reference": at["inflow_meter"]}
        measured.append("inflow_meter")
    free = {"flow.local_setpoint": at["duty_flow"], "flow.setpoint_source": 1.0}
    return controller(well.model, blocks, settings, measured=measured, free=free)


def test_cascade_rejects_what_happens_inside_the_flow_loop(well):
    """The works raise the end of the main by 2 m: the speed for the same flow is another one."""
    change = {"duty.static_head": 10.0}
    found = {}
    for name, made in (("single", single(well)), ("cascade", cascade(well))):
        values = run(made, well.model, 900, change)
        found[name] = np.abs(values["well.level"] - well.low).max()
        assert abs(values["well.level"][-1] - well.low) < 1e-3
        assert values["duty"][-1] > well.model.point.as_dict()["duty"] + 0.05
    assert found["single"] > 0.015  # [m]
    assert found["cascade"] < found["single"] / 5


def test_cascade_is_no_worse_at_what_happens_outside(well):
    deviations = [
        np.abs(run(made, well.model, 900, inflow=0.03)["well.level"] - well.low).max()
        for made in (single(well), cascade(well))
    ]
    assert deviations[1] < 1.1 * deviations[0]


@pytest.mark.thorough
def test_an_inner_loop_makes_a_bent_characteristic_straight(well):
    """Level steps at half and at 1.5 times the flow: the pump's gain differs, the loop's not."""
    spread = {}
    for name, made in (("single", single(well)), ("cascade", cascade(well))):
        returns = []
        for inflow in (0.006, 0.036):
            settled = run(made, well.model, 2000, inflow=inflow)
            load = np.full(3000, inflow)
            load[2000:] += 0.002
            after = run(made, well.model, 3000, inflow=load)
            returns.append(np.abs(after["well.level"][2000:] - settled["well.level"][-1]).max())
        spread[name] = max(returns) / min(returns)
    assert spread["single"] > 1.5
    assert spread["cascade"] < 1.1


@pytest.mark.thorough
def test_a_cascade_at_its_limit_does_not_wind_up(well):
    """For 30 min more runs in than the pump can lift: the outer integral waits for it."""
    inflow = np.full(4000, 0.02)
    inflow[100:1000] = 0.041
    found = run(cascade(well), well.model, 4000, inflow=inflow)
    assert np.all(found["duty"][200:1000] == 1.0)
    assert found["well.level"].max() > well.low + 0.3
    # The outer integral stays with what the pump gives.
    inner = scanned(cascade(well), well.model, found)
    assert np.abs(inner["level.integral"][500:1000] - found["duty_flow"][500:1000]).max() < 0.003
    # Then the level comes back, and goes below its setpoint as a PI loop does.
    assert well.low - found["well.level"].min() < 0.1
    assert abs(found["well.level"][-1] - well.low) < 1e-3
    wound = run(cascade(well, form=PidForm(anti_windup="none")), well.model, 4000, inflow=inflow)
    assert well.low - wound["well.level"].min() > 0.5


def test_feedforward_takes_most_of_an_inflow_away(well):
    deviation = {
        name: np.abs(run(made, well.model, 900, inflow=0.03)["well.level"] - well.low).max()
        for name, made in (("without", cascade(well)), ("with", cascade(well, feedforward=True)))
    }
    assert deviation["without"] > 0.015  # [m]
    assert deviation["with"] < 0.3 * deviation["without"]


# The equalisation basin with acid: flows [m³/s], level, speed and dosing [1]; a minute a sample.
def swings(samples, low=0.1, high=0.5, period=6 * HOUR):
    time = 60.0 * np.arange(samples)
    return (low + high) / 2 + (high - low) / 2 * np.sin(2 * math.pi * time / period)


def test_ratio_follows_the_wild_flow():
    model = model_of("equalisation-tank:dosing")
    process, at = model.point.process, model.point.as_dict()
    names = "level", "inflow_meter", "acid_meter", "outflow", "acid"
    level, inflow, acid_meter, outflow, acid = (process.signal(name) for name in names)

    def made(with_ratio):
        loop = PidBlock.of(level, PI, outflow)
        blocks = [loop, OutputBlock(outflow, loop.name)]
        settings, free = pid("level", -2.0, 20000.0), {}
        if with_ratio:
            blocks += [
                RatioBlock("ratio", "dosing", inflow, acid_meter, None),
                PidBlock("acid flow", "acid_flow", PI, acid_meter, acid, "ratio", inner=True),
                OutputBlock(acid, "acid flow"),
            ]
            # One step of integral action almost: the meter settles within a sample.
            settings |= pid("acid_flow", 20.0, 12.0) | {"dosing.ratio": 0.01}
            free = {"acid_flow.local_setpoint": at["acid_meter"], "acid_flow.setpoint_source": 1.0}
        measured = ["level", "inflow_meter", "acid_meter"] if with_ratio else ["level"]
        return controller(model, blocks, settings, measured=measured, free=free)

    load, worn = swings(720), {"acid.gain": 0.9 * 6e-3}  # [m³/s] at full speed
    error = {}
    for name, with_ratio in (("fixed", False), ("ratio", True)):
        found = run(made(with_ratio), model, 720, worn, inflow=load)
        dosed = found["acid"][60:] * worn["acid.gain"]
        error[name] = np.abs(dosed / load[60:] / 0.01 - 1.0).max()
    assert error["fixed"] > 0.5
    assert error["ratio"] < 0.04


@pytest.fixture(scope="module")
def basin():
    model = model_of("equalisation-tank")
    process = model.point.process
    return SimpleNamespace(
        model=model, level=process.signal("level"), outflow=process.signal("outflow")
    )


def averaging(basin, form=PI, **more):
    """A loose loop: a pump speed of 50 % more at 25 % of level more, and slow integral action."""
    loop = PidBlock.of(basin.level, form, basin.outflow)
    settings = pid("level", -2.0, 40000.0, **more)
    if form.error != "linear":
        del settings["level.setpoint_weight"]
    blocks = [loop, OutputBlock(basin.outflow, loop.name)]
    return controller(basin.model, blocks, settings, measured=["level"])


def test_split_range_uses_the_second_outlet_only_beyond_the_first(basin):
    """Ten hours of 0.6 m³/s, more than the pump can lift, then three of the mean."""
    model = model_of("equalisation-tank:relief")
    process = model.point.process
    level, outflow, relief = (process.signal(n) for n in ("level", "outflow", "relief"))
    range_ = Signal("split", "%", low=0.0, high=100.0)
    first = Leg("split.outflow", outflow, 0.0, 60.0, 0.0, 1.0)
    second = Leg("split.relief", relief, 60.0, 100.0, 0.0, 1.0)
    loop = PidBlock.of(level, PI, range_, direct=False)
    blocks = [
        loop,
        SplitRangeBlock("split", loop.name, (first, second)),
        OutputBlock(outflow, "split, outflow"),
        OutputBlock(relief, "split, relief"),
    ]
    rest = {"outflow": 0.614, "relief": 0.0}
    made = controller(model, blocks, pid("level", -180.0, 20000.0), measured=["level"], rest=rest)
    inflow = np.full(2400, 0.307)
    inflow[60:660] = 0.6
    found = run(made, model, 2400, inflow=inflow)
    assert found["relief"].max() > 0.1
    assert np.all(found["outflow"][found["relief"] > 0.0] == 1.0)
    assert found["relief"][:60].max() == 0.0
    assert found["relief"][-900:].max() == 0.0
    assert 0.55 < found["outflow"][-1] < 0.7
    assert found["basin.spilt"][-1] == 0.0
    # The valve opens as far as the pump is short of.
    short = 0.6 - 0.5
    assert found["basin.level"].max() < 4.8
    without = run(averaging(basin), basin.model, 2400, inflow=inflow)
    assert without["basin.spilt"][-1] > 0.5 * short * 600 * 60 - 2400
    assert without["basin.spilt"][-1] > 100.0  # [m³]


def override(basin):
    """The averaging loop, and one that keeps the level below 80 %: the pump takes the higher."""
    limiting = PidForm(remote_setpoint=True)
    blocks = [
        PidBlock("average", "average", PI, basin.level, basin.outflow, "level.sp", direct=False),
        PidBlock("limit", "limit", limiting, basin.level, basin.outflow, "level.sp", direct=False),
        SelectorBlock("higher", ("average", "limit"), "high"),
        OutputBlock(basin.outflow, "higher"),
    ]
    settings = pid("average", -0.5, 40000.0) | pid("limit", -6.0, 3000.0)
    free = {"limit.remote_setpoint": 0.8, "limit.setpoint_source": 1.0}
    return controller(basin.model, blocks, settings, measured=["level"], free=free)


def loose(basin):
    loop = PidBlock("average", "average", PI, basin.level, basin.outflow, "level.sp")
    return controller(
        basin.model, [loop, OutputBlock(basin.outflow, "average")], pid("average", -0.5, 40000.0),
        measured=["level"],
    )  # fmt: skip


def long_rain():
    inflow = np.full(2000, 0.307)
    inflow[100:1200] = 0.48
    inflow[1200:1800] = 0.2
    return inflow


@pytest.fixture(scope="module")
def overridden(basin):
    """The override in the long rain: what the plant does, and what is inside the law."""
    made = override(basin)
    found = run(made, basin.model, 2000, inflow=long_rain())
    return found, scanned(made, basin.model, found)


def test_override_keeps_the_limit_and_otherwise_leaves_the_averaging_loop_alone(basin, overridden):
    found, inner = overridden
    without = run(loose(basin), basin.model, 2000, inflow=long_rain())
    assert without["level"].max() > 0.9
    assert found["level"].max() < 0.83
    limits = inner["limit.unlimited"] > inner["average.unlimited"]
    assert 200 < limits.sum() < 1500
    assert not limits[:200].any()
    assert not limits[1400:].any()
    # Until the limit comes near, the pump does what it does without the override.
    np.testing.assert_allclose(found["outflow"][:200], without["outflow"][:200], rtol=0, atol=1e-12)


def test_override_takes_over_and_gives_back_without_a_bump_or_wind_up(overridden):
    found, inner = overridden
    average, limiting = inner["average.unlimited"], inner["limit.unlimited"]
    np.testing.assert_array_equal(
        found["outflow"], np.clip(np.maximum(average, limiting), 0.0, 1.0)
    )
    higher = limiting > average
    changes = np.flatnonzero(higher[1:] != higher[:-1]) + 1
    assert len(changes) >= 2
    # What each loop moves by its own action, from the output before it: K (Δy + Δt/Ti (y - r)).
    level, bumps = found["level"], np.diff(found["outflow"])
    own = [
        k * (np.diff(level) + 60.0 / ti * (level[:-1] - setpoint))
        for k, ti, setpoint in ((0.5, 40000.0, 0.5), (6.0, 3000.0, 0.8))
    ]
    for k in changes:
        before, after = (own[int(higher[place])][k - 1] for place in (k - 1, k))
        assert 0.0 < found["outflow"][k - 1] < 1.0
        assert before - 1e-9 <= bumps[k - 1] <= after + 1e-9
        assert after - before > 1e-5
    # The integral of the loop that waits stays where the pump is; by its own error it would go
    # far away in the first five hours, and the limit would come late.
    assert 6.0 * 60.0 / 3000.0 * (0.8 - level[:300]).sum() > 5.0
    assert inner["limit.integral"].min() > 0.4
    assert 0.5 < inner["average.integral"].min() < inner["average.integral"].max() < 1.0


def test_gap_action_leaves_the_outflow_still_and_holds_the_limits(basin):
    gap = averaging(basin, PidForm(error="gap"), gap=0.1, gap_gain=0.02)
    _check_gentle(basin, gap, share=0.05)


def test_error_squared_leaves_the_outflow_still_and_holds_the_limits(basin):
    squared = averaging(basin, PidForm(error="squared"), squared_error_scale=0.25)
    _check_gentle(basin, squared, share=0.25)


def _check_gentle(basin, made, share):
    """Small swings and noise move the pump by a share of what the linear loop does."""
    inflow = 0.307 + 0.05 * np.sin(2 * math.pi * np.arange(2880) / 120.0)
    noise = 0.002 * np.random.default_rng(1).normal(size=2880)
    linear = averaging(basin)
    moved = [
        travel(run(c, basin.model, 2880, inflow=inflow, level__noise=noise)["outflow"])
        for c in (linear, made)
    ]
    assert moved[0] > 1.0
    assert moved[1] < share * moved[0]
    # The load step lasts for two days.
    step = np.full(2880, 0.427)
    step[:30] = 0.307
    levels = [run(c, basin.model, 2880, inflow=step)["level"] for c in (linear, made)]
    assert levels[0].max() < 0.7
    assert 0.6 < levels[1].max() < 0.9


# Start and stop levels in the wet well.
@pytest.fixture(scope="module")
def station():
    plant = cl.load("wet-well:start-stop")
    return SimpleNamespace(model=plant.linear, controller=cl.design.start_stop_levels(plant))


PUMPS = "duty", "standby"
HALF_A_DAY = round(12 * HOUR / 2.0)  # in samples of 2 s


def starts(values, pump):
    return np.flatnonzero(np.diff(values[pump]) > 0.0) + 1


@pytest.mark.sampled
@pytest.mark.parametrize("inflow", [0.008, 0.019, 0.03, 0.06])
def test_starts_an_hour_stay_within_what_was_designed(station, inflow):
    """At 19 l/s, half of what a pump lifts there, the pumps start most often."""
    found = run(station.controller, station.model, HALF_A_DAY, inflow=inflow)
    for pump in PUMPS:
        begins = 2.0 * starts(found, pump)
        for first, last in pairwise(begins):
            assert last - first >= HOUR / 10
        assert found["well.spilt"][-1] == 0.0


def test_a_third_of_the_volume_means_three_times_the_starts(station):
    """So the levels are what limits them."""
    narrow = dict(station.controller.values)
    for j in (1, 2):
        start, stop = (f"stage.{j}.{what}_level" for what in ("start", "stop"))
        narrow[start] = narrow[stop] + (narrow[start] - narrow[stop]) / 3.0
    narrow |= {"alternation": 0.0}
    changed = {controller_name(k): v for k, v in narrow.items()}
    often = run(station.controller, station.model, HALF_A_DAY, changed, inflow=0.019)
    assert len(starts(often, "duty")) > 20 * 12


def test_alternation_shares_the_starts(station):
    found = run(station.controller, station.model, 20000, inflow=0.019)
    count = [len(starts(found, pump)) for pump in PUMPS]
    assert count[0] > 25
    assert abs(count[0] - count[1]) <= 1
    changed = {"controller.alternation": 0.0}
    alone = run(station.controller, station.model, 20000, changed, inflow=0.019)
    assert len(starts(alone, "standby")) == 0
    assert len(starts(alone, "duty")) == pytest.approx(sum(count), abs=2)


def test_standby_takes_over_from_a_pump_in_an_operators_hand(station):
    """The duty pump stands at 0 in manual: the other one does it all, and nothing spills."""
    found = run(
        station.controller, station.model, 8000, inflow=0.03, duty__mode=0.0, duty__manual=0.0
    )
    assert found["duty"].max() == 0.0
    assert len(starts(found, "standby")) > 20
    assert found["well.level"][500:].max() < 1.3
    both = run(
        station.controller, station.model, 8000, inflow=0.03, duty__mode=0.0, duty__manual=0.0,
        standby__mode=0.0, standby__manual=0.0,
    )  # fmt: skip
    assert both["well.spilt"][-1] > 100.0


def test_standby_helps_where_one_pump_is_not_enough(station):
    inflow = np.full(8000, 0.02)
    inflow[1000:3000] = 0.06
    found = run(station.controller, station.model, 8000, inflow=inflow)
    together = (found["duty"] == 1.0) & (found["standby"] == 1.0)
    assert together[1000:3000].sum() > 500
    assert not together[3300:].any()
    assert found["well.level"].max() < 2.5
    assert found["well.spilt"][-1] == 0.0
    changed = {"controller.standby.in_service": 0.0}
    alone = run(station.controller, station.model, 8000, changed, inflow=inflow)
    assert alone["standby"].max() == 0.0
    assert alone["well.spilt"][-1] > 10.0


def test_nothing_spills_at_the_load_step(station):
    step = np.full(8000, 0.02)
    step[1000:] = 0.03
    found = run(station.controller, station.model, 8000, inflow=step)
    assert found["well.spilt"][-1] == 0.0
    assert found["well.level"][500:].max() < 1.3
    assert found["well.level"].min() > 0.7
