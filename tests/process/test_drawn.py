"""Plants that are drawn from a number."""

import pytest
from refusals import refused

import clepsydra as cl


def ratios(process, number):
    """Return by how much each parameter that was drawn differs from the file's."""
    own, other = cl.load(process).process, cl.load(f"{process}#{number}").process
    pairs = zip(own.parameters, other.parameters, strict=True)
    return {a.name: b.initial / a.initial for a, b in pairs if a.initial != b.initial}


def test_holes_splits_and_gains_are_drawn_within_ten_percent():
    found = [ratios("laboratory-four-tanks", number) for number in range(1, 41)]
    holes = {f"outlet_{tank}.area" for tank in (1, 2, 3, 4)}
    gains = {f"pump_{pump}.gain" for pump in (1, 2)}
    splits = {f"splitter_{pump}.tank_{pump}" for pump in (1, 2)}
    assert all(set(each) == holes | gains | splits for each in found)
    every = [value for each in found for value in each.values()]
    assert min(every) >= 0.9 and max(every) <= 1.1
    # Of 320 that are uniform some are near either end, and their mean is in the middle.
    assert min(every) < 0.91 and max(every) > 1.09
    assert sum(every) / len(every) == pytest.approx(1.0, abs=4 * 0.0577 / len(every) ** 0.5)


def test_a_number_draws_the_same_everywhere():
    """Integers decide, so these are the numbers of every machine."""
    found = cl.load("quadruple-tank#7").process.signal("outlet_2.area").initial / 0.057e-4
    word = 3910189026  # the first of Philox for the stream of its name, of draws, under the key 7
    assert found == pytest.approx(0.9 + 0.2 * word / 0xFFFFFFFF, rel=1e-15)


def test_two_set_ups_of_one_rig_are_drawn_alike():
    one, other = (ratios(f"laboratory-four-tanks{phase}", 5) for phase in ("", "-nonminimum-phase"))
    assert one == pytest.approx(other, rel=1e-15)


def test_a_drawn_plant_has_an_address_that_loads_it_again():
    plant = cl.load("laboratory-four-tanks:fitted,volts#12")
    assert plant.process.address == "laboratory-four-tanks:fitted,volts#12"
    assert plant.process.file_stem == "laboratory-four-tanks-fitted-volts-12"
    assert cl.load("quadruple-tank#0").process.address == "quadruple-tank"


def test_a_study_file_is_drawn_by_its_number(tmp_path):
    path = tmp_path / "tanks.toml"
    path.write_text('process = "quadruple-tank"\ncontrollers.PI.design = "simc"\n')
    found = cl.study(f"{path}#7", only="PI")
    assert found.process.address == "quadruple-tank#7"
    assert found.plant.point.as_dict()["tank_1.level"] == pytest.approx(
        cl.load("quadruple-tank#7").point.as_dict()["tank_1.level"], rel=1e-12
    )


def test_what_has_nothing_to_draw_is_refused():
    with refused(value=3, expected="no hole, split or gain"):
        cl.load("wet-well#3")
    with refused(value=10**12, remedy="0 is the process as its file has it"):
        cl.load(f"quadruple-tank#{10**12}")
