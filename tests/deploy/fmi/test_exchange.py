"""FMUs of processes for model exchange: derivatives, events, and a trajectory by CVode."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from fmus import VERSIONS, Imported, all_bits, cases, written
from models import FRICTIONS, exchange_of, origin, rig
from plants import plant

from clepsydra import InputError
from clepsydra.deploy.fmi.exchange import exchange_model
from clepsydra.loop.motion_block import motion_at_rest
from clepsydra.loop.open_loop import simulate
from clepsydra.process.catalogue_names import catalogue_names

POINTS = 200

pytestmark = pytest.mark.thorough


def started(model, folder, version: str) -> Imported:
    path = written(model, folder, version)
    assert validate_fmu(str(path)) == []
    return Imported(path, folder).initialise()


@pytest.fixture(scope="module")
def tanks(tmp_path_factory):
    """Return a function that makes an instance of the quadruple tank."""
    folder = tmp_path_factory.mktemp("tanks")
    paths = {version: written(exchange_of("quadruple-tank"), folder, version)
             for version in VERSIONS}  # fmt: skip
    return lambda version: Imported(paths[version], folder).initialise()


class Equations:
    """The functions of the motion, evaluated by CasADi."""

    def __init__(self, point) -> None:
        self.process, self.motion = point.process, point.process.motion
        rest = motion_at_rest(point)
        self.c = np.array([rest[s.name] for s in self.motion.contents])
        self.m = self.kept = np.array([rest[s.name] for s in self.motion.memories])
        self.u, self.d = point.inputs.copy(), point.disturbances.copy()
        self.p = self.process.parameter_values

    def call(self, name, *before):
        function = getattr(self.motion, name)
        result = function(*before, self.c, [], self.m, self.u, self.d, self.p)
        return np.array(result[0] if isinstance(result, tuple) else result).ravel()

    def results(self, memories) -> np.ndarray:
        """The bits of everything that is computed, with these memories."""
        own, self.m = self.m, memories
        found = [*self.call("rates"), *self.call("guards"), *self.outputs()]
        self.m = own
        return all_bits(found)

    def outputs(self) -> list[float]:
        x = np.array(self.motion.to_state(self.c, self.p)).ravel()
        measured = np.array(self.process.measure(x, self.p)).ravel()
        # A sensor stops at the end of its range; one of 4 to 20 mA goes on from 3.8 to 20.5 mA.
        ends = [(0.0038, 0.0205) if s.unit == "A" else (s.low, s.high)
                for s in self.process.measurements]  # fmt: skip
        return [*x, *np.clip(measured, *np.array(ends).T)]

    def completed(self) -> bool:
        """End a step: keep what it leaves behind, and say whether that is an event."""
        own, self.m = self.m, self.kept
        self.kept, self.m = self.call("updates"), own
        return not np.array_equal(self.results(self.m), self.results(self.kept))

    def event(self) -> bool:
        """Carry out events once, and say whether more follow."""
        self.m = self.kept
        fired = self.call("guards") >= 0
        if fired.any():
            self.m = self.kept = self.call("resets", fired)
        return bool((self.call("guards") >= 0).any())

    def at_random(self, random) -> None:
        scale = np.array([s.high if np.isfinite(s.high) else 1.0 for s in self.motion.contents])
        self.c = scale * random.uniform(0.0, 1.1, len(scale))
        for values, signals in ((self.u, self.process.inputs), (self.d, self.process.disturbances)):
            for k, signal in enumerate(signals):
                low, high = signal.low, signal.high
                values[k] = random.uniform(*((low, high) if np.isfinite(high - low) else (0, 1)))


def exact(point, folder, version: str) -> int:
    """Compare derivatives, indicators and outputs at random points, and memories in events.

    Returns how often a step asked for an event.
    """
    process, equations = point.process, Equations(point)
    fmu = started(exchange_model(point, origin(process.name, 1.0)), folder, version)
    update = fmu.fmu.updateDiscreteStates if fmu.third else fmu.fmu.newDiscreteStates
    contents = [s.name for s in process.motion.contents]
    memories = [s.name for s in process.motion.memories]
    outputs = [s.name for s in (*process.state, *process.measurements)]
    random, size = np.random.default_rng(4), len(contents)
    assert np.array_equal(fmu.vector("ContinuousStates", size), equations.c)
    equations.completed()

    def settle() -> None:
        more = True
        while more:
            more = equations.event()
            assert update()[0] == more
            assert fmu.get_all(memories) == list(equations.m)

    settle()
    fmu.fmu.enterContinuousTimeMode()
    events = 0
    for _ in range(POINTS):
        equations.at_random(random)
        fmu.set_states(equations.c)
        names = [s.name for s in (*process.inputs, *process.disturbances)]
        fmu.set(dict(zip(names, [*equations.u, *equations.d], strict=True)))
        expected = equations.call("rates")
        found = fmu.vector("Derivatives", size)
        assert np.array_equal(all_bits(found), all_bits(expected))
        assert fmu.get(f"der({contents[0]})") == expected[0]
        guards = equations.call("guards")
        if len(guards):
            assert np.array_equal(
                all_bits(fmu.vector("EventIndicators", len(guards))), all_bits(guards)
            )
        assert np.array_equal(all_bits(fmu.get_all(outputs)), all_bits(equations.outputs()))
        asked, ended = fmu.fmu.completedIntegratorStep()
        assert (asked, ended) == (equations.completed(), False)
        assert fmu.get_all(memories) == list(equations.m)  # discrete: not outside event mode
        events += asked
        if asked or (guards >= 0).any() or random.uniform() < 0.2:
            fmu.fmu.enterEventMode()
            settle()
            fmu.fmu.enterContinuousTimeMode()
    fmu.close()
    return events


@pytest.mark.parametrize(("name", "version"), cases(catalogue_names()))
def test_derivatives_guards_and_outputs_are_those_of_the_equations(name, version, tmp_path):
    assert exact(plant(name).point, tmp_path, version) == 0


@pytest.mark.parametrize(("friction", "version"), cases(FRICTIONS))
def test_memories_change_in_event_mode_only(friction, version, tmp_path):
    events = exact(rig(tmp_path, friction), tmp_path, version)
    # A stuck stem moves at events that have indicators; play is noticed at the end of a step.
    assert (events > 10) == (friction == FRICTIONS[0])


@pytest.mark.parametrize("version", VERSIONS)
def test_a_stem_asks_for_an_event_where_it_is_left_behind(version, tmp_path):
    """Play of 6 %: pushed from 60 % to 70 % the stem is at 67 %, and stays there on the way back.

    That it stays is what its memory tells: until then no event is asked for.
    """
    point = rig(tmp_path, FRICTIONS[0])
    fmu = started(exchange_model(point, origin("rig", 1.0)), tmp_path, version)
    states = [s.name for s in point.process.motion.contents]
    place, values = states.index("throttle.position"), Equations(point).c
    fmu.settle()
    assert fmu.get("throttle.stem") == 0.6
    fmu.fmu.enterContinuousTimeMode()

    def moved(position: float) -> tuple[bool, np.ndarray]:
        values[place] = position
        fmu.set_states(values)
        rates = fmu.vector("Derivatives", len(values))
        return fmu.fmu.completedIntegratorStep()[0], rates

    pushed = [moved(position) for position in (0.61, 0.63, 0.65, 0.68, 0.70)]
    assert not any(asked for asked, _ in pushed)
    assert fmu.get("throttle.stem") == 0.6
    asked, there = moved(0.69)
    assert asked
    fmu.fmu.enterEventMode()
    assert fmu.settle() == 1
    assert fmu.get("throttle.stem") == pytest.approx(0.67, abs=1e-15)
    fmu.fmu.enterContinuousTimeMode()
    # The flow is that of the stem at 67 %, which it had at the end of the way up.
    upper = states.index("upper.level")
    back = [moved(position) for position in (0.69, 0.66, 0.645)]
    assert not any(asked for asked, _ in back)
    assert {rates[upper] for _, rates in back} == {pushed[-1][1][upper]}
    assert there[upper] != pushed[-1][1][upper]
    assert not moved(0.60)[0]
    fmu.close()


def integrated(path, profiles, times, outputs, tolerance: float = 1e-10):
    """Integrate by FMPy's CVode; the inputs jump where the profiles change."""
    names = list(profiles)
    jumps = np.flatnonzero(np.any([np.diff(profiles[name]) for name in names], axis=0)) + 1
    places = [0, *(place for jump in jumps for place in (jump - 1, jump)), len(times) - 1]
    table = np.zeros(len(places), dtype=[("time", float), *((name, float) for name in names)])
    table["time"] = times[[0, *np.repeat(jumps, 2), len(times) - 1]]
    for name in names:
        table[name] = profiles[name][places]
    return fmpy.simulate_fmu(
        str(path), stop_time=float(times[-1]), solver="CVode", relative_tolerance=tolerance,
        output_interval=float(times[1]), input=table, output=outputs,
    )  # fmt: skip


@pytest.mark.parametrize(("name", "version"), [("quadruple-tank", "2.0")])
def test_cvode_goes_where_the_reference_goes(name, version, tmp_path):
    point = plant(name).point
    path = written(exchange_of(name), tmp_path, version)
    times = np.arange(121.0)
    profiles = {
        "pump_1": np.where(times < 40, 3.6, 2.7),
        "pump_2": np.where(times < 70, 3.0, 3.5),
        "inflow_1": np.where(times < 20, 0.0, 2e-6),
    }
    run = simulate(
        point, {name: values[:-1] for name, values in profiles.items()}, substeps=1,
        solver="reference",
    )  # fmt: skip
    outputs = [s.name for s in point.process.state]
    found = integrated(path, profiles, times, outputs)
    assert len(found["time"]) >= len(times)
    for output in outputs:
        there = np.interp(times, found["time"], found[output])
        assert np.ptp(run.values[output]) > 1e-3
        assert there == pytest.approx(run.values[output], abs=2e-8)


@pytest.mark.parametrize(("name", "version"), cases(["wet-well"]))
def test_events_happen_where_the_reference_finds_them(name, version, tmp_path):
    """The wet well fills and is pumped down again and again: its pumps start and stop by level."""
    point = plant(name).point
    path = written(exchange_of(name), tmp_path, version)
    period = point.process.sampling_period
    times = period * np.arange(1201.0)
    profiles = {"inflow": np.where((times > 400) & (times < 1200), 0.06, 0.005)}
    run = simulate(
        point, {name: values[:-1] for name, values in profiles.items()}, substeps=1,
        solver="reference",
    )  # fmt: skip
    memories = [s.name for s in point.process.motion.memories]
    outputs = [point.process.state[0].name, *memories]
    found = integrated(path, profiles, times, outputs)
    switched = 0
    for memory in memories:
        expected = np.flatnonzero(np.diff(run.values[memory]))
        changes = np.flatnonzero(np.diff(found[memory]))
        at = found["time"][changes + 1]
        assert len(at) == len(expected), memory
        # The reference records at samples: the event lies in the sample before.
        assert np.all(at > times[expected] - 1e-6)
        assert np.all(at <= times[expected + 1] + 1e-6)
        switched += len(at)
    assert switched >= 2
    level = outputs[0]
    there = np.interp(times, found["time"], found[level])
    assert there == pytest.approx(run.values[level], abs=1e-6)


@pytest.mark.parametrize(("friction", "version"), cases(FRICTIONS))
def test_a_valve_with_friction_goes_where_the_reference_goes(friction, version, tmp_path):
    """There and back within the play, there and back beyond it, and turned round on its way."""
    point = rig(tmp_path, friction)
    path = written(exchange_model(point, origin("rig", 1.0)), tmp_path, version)
    times = np.arange(121.0)
    throttle = np.select(
        [times < t for t in (20, 40, 60, 66, 90)], [0.6, 0.8, 0.77, 0.3, 0.9], default=0.72
    )
    profiles = {"throttle": throttle, "feed": np.full(121, 4.0)}
    run = simulate(
        point, {name: values[:-1] for name, values in profiles.items()}, substeps=1,
        solver="reference",
    )  # fmt: skip
    outputs = [s.name for s in point.process.state]
    found = integrated(path, profiles, times, outputs)
    for output in outputs:
        last = len(found["time"]) - 1 - np.searchsorted(-found["time"][::-1], -times)
        there = found[output][last]
        assert there == pytest.approx(run.values[output], rel=1e-6, abs=1e-6), output
    assert np.ptp(run.values["upper.level"]) > 1e-2
    # An event at each jump, and few beside them.
    assert len(found["time"]) < 2 * len(times)


def test_a_transport_delay_is_refused_and_co_simulation_named(tmp_path):
    with pytest.raises(InputError, match=r"channel.*transport delay of 7.5 s.*co-simulation"):
        exchange_model(rig(tmp_path, delay=True), origin("rig", 1.0))


@pytest.mark.parametrize("version", VERSIONS)
def test_the_modes_are_kept_apart(version, tanks):
    fmu = tanks(version)
    with pytest.raises(FMICallException):
        fmu.set_states(np.zeros(4))
    assert "not allowed in this phase" in fmu.said[-1]
    fmu.settle()
    fmu.fmu.enterContinuousTimeMode()
    with pytest.raises(FMICallException):
        fmu.set_states(np.zeros(3))
    assert "the model has 4 of them, not 3" in fmu.said[-1]
    with pytest.raises(FMICallException):
        fmu.set({"tank_1.area": 1.0})
    assert "cannot be set now" in fmu.said[-1]
    kept = fmu.state()
    fmu.set_states([0.1, 0.1, 0.05, 0.05])
    moved = fmu.vector("Derivatives", 4)
    fmu.set_state(kept)
    assert np.abs(fmu.vector("Derivatives", 4)).max() < 1e-15 < np.abs(moved).max()
    fmu.free_state(kept)
    fmu.close()


@pytest.mark.parametrize("version", VERSIONS)
def test_nominal_values_are_the_size_of_the_states(version, tanks):
    fmu = tanks(version)
    expected = [s.high for s in plant("quadruple-tank").process.state]
    assert list(fmu.vector("NominalsOfContinuousStates", 4)) == expected
    fmu.close()
