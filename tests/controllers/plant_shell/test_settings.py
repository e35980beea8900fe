"""Settings of the shell, what is refused, and where its numbers come from."""

from dataclasses import replace

import pytest
from refusals import refused
from scan_rig import ScannedLaw
from shell_rig import LEVEL, one_loop

from clepsydra import InputError, PidForm, Signal, python_law
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.controllers.plant_shell.settings import PlantShell
from clepsydra.controllers.plant_shell.shell import shell_sources, with_plant_shell
from clepsydra.controllers.plant_shell.status import SHELL_STATUS_BITS
from clepsydra.controllers.wiring import check_wiring
from clepsydra.program.step_law import Equations, step_law


@pytest.mark.parametrize(
    ("wrong", "place", "value"),
    [
        ({"sensor_delay": {"level_1": float("nan")}}, "sensor_delay, level_1", "nan"),
        ({"sensor_delay": {"level_1": (0.0, 1.0)}}, "sensor_delay, level_1", "(0.0, 1.0)"),
        ({"sensor_delay": {"level_1": -1.0}}, "sensor_delay, level_1", "-1.0"),
        ({"sensor_delay": {"level_1": "4 s"}}, "sensor_delay, level_1", "4 s"),
        ({"setpoint_rate": {"level_1": 0.0}}, "setpoint_rate, level_1", "0.0"),
        ({"rate_limit": {"pump_1": -2.0}}, "rate_limit, pump_1", "-2.0"),
        ({"fail_safe": {"pump_1": float("inf")}}, "fail_safe, pump_1", "inf"),
        ({"fail_safe": {"pump_1": True}}, "fail_safe, pump_1", "True"),
    ],
)
def test_values_out_of_range_are_refused(wrong, place, value):
    with pytest.raises(InputError) as caught:
        PlantShell(**wrong)
    found = caught.value
    assert (found.place, str(found.value)) == (f"plant shell, {place}", value)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"sensor_delay": {"level_2": 1.0}}, "measurement of the controller: level_1"),
        ({"sensor_delay": {"pump_1": 1.0}}, "measurement of the controller: level_1"),
        ({"setpoint_rate": {"level": 1.0}}, "perhaps 'level_1' was meant"),
        ({"rate_limit": {"level_1": 1.0}}, "manipulated variable of the controller: pump_1"),
        ({"fail_safe": {"pump_2": 1.0}}, "perhaps 'pump_1' was meant"),
        ({"fail_safe": {"pump_1": 10.5}}, "0 to 10 V"),
    ],
)
def test_settings_that_do_not_fit_the_controller_are_refused(settings, words):
    with pytest.raises(InputError, match=words):
        with_plant_shell(one_loop(), 1.0, PlantShell(**settings))


def test_a_law_in_python_is_refused_with_the_remedy():
    law = python_law(
        "still",
        lambda state, inputs, parameters, time_step: ({}, {"pump_1.out": 3.0}),
        inputs=[Signal("level_1.pv")],
        outputs=[Signal("pump_1.out")],
    )
    controller = Controller(
        "still", "own law", "", law, {"pump_1.low_limit": 0.0, "pump_1.high_limit": 10.0},
        {"pump_1.last_output": 3.0}, ("level_1",), (), ("pump_1",),
    )  # fmt: skip
    with refused(remedy="write it as expressions, by step_law"):
        with_plant_shell(controller, 1.0)


def whole_law(inputs, **options):
    """A law that gives its own status word, and asks for 4."""
    return step_law(
        "own",
        inputs=[Signal(name) for name in inputs],
        parameters=[Signal(name, initial=2.0) for name in options.get("parameters", ())],
        state=[],
        outputs=[Signal("pump_1.out", "V", low=0.0, high=10.0), Signal("pump_1.status")],
        equations=lambda s: Equations(
            {}, {"pump_1.out": 4.0, "pump_1.status": 17.0 - 16.0 * s.get("level_1.good", 1.0)}
        ),
    )


ALL = ("level_1.pv", "level_1.good", "pump_1.mode", "pump_1.manual", "pump_1.tracking", "time_step")


def own_controller(law, **values):
    return Controller("own", "own law", "", law, values, {}, ("level_1",), (), ("pump_1",))


def test_a_law_without_modes_is_refused():
    for missing in ALL[1:]:
        law = whole_law([name for name in ALL if name != missing])
        with pytest.raises(InputError, match=missing):
            with_plant_shell(own_controller(law), 1.0)


def test_a_law_without_limits_has_no_rate_limit_and_still_fails_safe():
    controller = own_controller(whole_law(ALL))
    shelled = with_plant_shell(controller, 1.0, PlantShell(fail_safe={"pump_1": 1.0}))
    assert "pump_1.rate_limit" not in shelled.values
    assert any("no limits of pump_1" in note for note in shelled.notes)
    with refused(expected="no limits"):
        with_plant_shell(controller, 1.0, PlantShell(rate_limit={"pump_1": 1.0}))
    loop = ScannedLaw(shelled, 1.0)
    loop.scan()
    assert loop.scans(4, level_1_good=0, pump_1_mode=1)["pump_1.out"] == 4.0
    assert loop.scan()["pump_1.out"] == 1.0
    assert loop.state["pump_1.last_output"] == 1.0


def test_a_name_of_the_shell_in_the_law_is_refused():
    law = whole_law(ALL, parameters=("sampling_period",))
    with refused(expected="leaves this name to the shell"):
        with_plant_shell(own_controller(law, sampling_period=2.0), 1.0)
    shelled = with_plant_shell(one_loop(), 1.0)
    with refused(expected="leaves this name to the shell"):
        with_plant_shell(shelled, 1.0)


def test_clamping_has_no_rate_limit_beside_it():
    clamped = one_loop(PidForm(anti_windup="clamping"))
    assert any("clamping" in note for note in with_plant_shell(clamped, 1.0).notes)
    with refused(expected="clamping"):
        with_plant_shell(clamped, 1.0, PlantShell(rate_limit={"pump_1": 1.0}))


def test_where_each_number_comes_from():
    settings = PlantShell(setpoint_rate={"level_1": 0.5}, rate_limit={"pump_1": 2.0})
    shelled = with_plant_shell(one_loop(), 1.0, settings)
    sources = shell_sources(shelled)
    added = {p.name for p in shelled.law.parameters} - set(one_loop().values)
    assert set(sources) == added
    assert (
        sources["level_1.setpoint_rate"]
        == sources["pump_1.rate_limit"]
        == "setting of the plant shell"
    )
    assert sources["level_1.sensor_delay"] == "default: 4 s"
    plain = shell_sources(with_plant_shell(one_loop(), 1.0))
    assert plain["level_1.setpoint_rate"] == "default: no ramp"
    assert plain["level_1.range_high"] == "range of level_1 in the process file"
    assert plain["pump_1.rate_limit"] == "default: no rate limit"
    assert plain["pump_1.fail_safe"] == "default: low limit of pump_1"
    assert shell_sources(one_loop()) == {}


def test_the_result_is_a_whole_controller():
    bare = one_loop()
    shelled = with_plant_shell(bare, 1.0)
    assert shelled.bare is bare
    assert (shelled.name, shelled.family, shelled.design) == (bare.name, bare.family, bare.design)
    assert set(shelled.values) == {p.name for p in shelled.law.parameters}
    assert set(shelled.initial_state) == {s.name for s in shelled.law.state}
    assert shelled.values["pump_1.low_limit"] == bare.values["pump_1.low_limit"]
    assert shelled.program().name == "multiloop_pi_with_shell"
    again = replace(shelled, values=shelled.values | {"level_1.sensor_delay": 2.0})
    assert again.program().parameters[-1].name == "take_up_scans"


def test_the_bits_follow_each_other_and_are_in_the_comment():
    values = [bit.value for bit in SHELL_STATUS_BITS.values()]
    # Single precision holds every whole number below 2**24, and a DINT below 2**31.
    assert values == [2**k for k in range(len(values))] and sum(values) < 2**24
    outputs = {s.name: s for s in with_plant_shell(one_loop(), 1.0).law.outputs}
    for bit in SHELL_STATUS_BITS.values():
        assert f" {bit.value} " in outputs["pump_1.status"].description
    assert outputs["pump_1.status"].kind == "integer"


def test_free_outputs_are_wired_to_the_controller_and_checked():
    shelled = with_plant_shell(one_loop(), 1.0)
    assert shelled.output_wires["watchdog"] == "controller.watchdog"
    law, signals = shelled.law, (["level_1"], ["level_1"], ["pump_1"])
    others = [name for name in shelled.free_outputs if name != "watchdog"]
    with refused(value="watchdog"):
        check_wiring(law, *signals, "PI", free=shelled.free_inputs, free_outputs=others)
    for wrong in ("whatchdog", "pump_1.status"):
        with refused(place="free outputs"):
            check_wiring(law, *signals, "PI", free=shelled.free_inputs, free_outputs=(wrong,))
    plain = multiloop_pid_law([LEVEL], ["pump_1"])
    check_wiring(plain, *signals, "PI")
