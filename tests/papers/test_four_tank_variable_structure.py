"""The document on four tanks with input constraint: what the reference says of it is found."""

import dataclasses
from collections import Counter

import pytest

from clepsydra.linear.analysis import analyse
from clepsydra.papers.four_tank_variable_structure import rig
from clepsydra.papers.four_tank_variable_structure.rig import at_target, plant

pytestmark = pytest.mark.thorough


@pytest.fixture(scope="module")
def findings(audited):
    parts = audited("four-tank-variable-structure").experiments
    return {part.experiment.name: part for part in parts}


@pytest.fixture(scope="module")
def verdicts(findings):
    rows = [row for found in findings.values() for row in found.rows]
    assert len({(row.place, row.name) for row in rows}) == len(rows)
    return {(row.place, row.name): row.verdict for row in rows}


def verdict(verdicts, place, words):
    found = {value for (where, name), value in verdicts.items() if where == place and words in name}
    assert len(found) == 1, (place, words, found)
    return found.pop()


def test_its_page_prints_what_the_audit_finds(page_holds):
    assert page_holds("four-tank-variable-structure")


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("section 2", "A dh/dt of a tank"),  # the lost minus sign
        ("section 3", "dy1/dt"),
        ("section 3", "L(x), second entry"),  # the lost minus sign
        ("section 3", "derivative in which the input appears"),
        ("(11)", "sum up to n − 1"),
        ("(14)", "K_1"),
    ],
)
def test_every_misprint_of_the_reference_is_found(verdicts, place, words):
    assert verdict(verdicts, place, words) == "misprint"


def test_nothing_else_is_called_a_misprint(verdicts):
    assert Counter(verdicts.values())["misprint"] == 6


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("section 2", "A1 dh1/dt"), ("section 2", "A2 dh2/dt"), ("section 2", "A3 dh3/dt"),
        ("section 2", "A4 dh4/dt"), ("section 3", "dy2/dt"), ("section 3", "relative degree"),
        ("section 3", "L(x), first entry"), ("section 3", "E(x), row"), ("(9)", "Y under"),
        ("(12)", "Y under"), ("(13)", "r = 1"),
    ],
)  # fmt: skip
def test_what_the_document_derives_is_reproduced(verdicts, place, words):
    assert verdict(verdicts, place, words) == "reproduced"


@pytest.mark.parametrize(
    ("place", "words", "expected"),
    [
        # E non-singular is not sufficient: the zeros of P+ are the internal dynamics.
        ("section 3", "determinant of E", "claim holds"),
        ("section 3", "decoupling of P−", "claim holds"),
        ("section 3", "decoupling of P+", "claim fails"),
        ("section 3", "upper levels of P+", "claim fails"),
        # The baseline: around 12 % for tank 1, and it only can because α takes speed away.
        ("section 5", "overshoot of h1, conventional PID", None),
        ("section 5", "rise time of h1", "claim fails"),
        ("section 5", "settling time to 2 % of h1", "claim holds"),
        ("section 5", "time of v1 at a limit", "claim holds"),
        ("section 5", "over the rims, conventional", "claim holds"),
        ("section 5", "overshoot with pumps up to 20 V", "claim fails"),
        ("section 5", "settling with pumps up to 8 V", "claim fails"),
        ("section 5", "settling with pumps up to 12 V", "claim holds"),
        ("section 6", "against conditional integration, in volts", "claim fails"),
        ("section 4, (2)", "α = 0.1 of loop 1, PI controllers in volts", "claim fails"),
        ("section 4, (2)", "linearised, α in ν", "claim holds"),
        ("section 4, (2)", "linearised, α in volts", "claim fails"),
    ],
)
def test_claims_hold_and_fail_as_the_reference_says(verdicts, place, words, expected):
    if expected is None:
        assert verdicts[place, words] == "reproduced"
    else:
        assert verdict(verdicts, place, words) == expected


def test_the_trap_has_the_rate_of_the_zero(findings):
    (row,) = [r for r in findings["internal"].rows if "upper levels" in r.name]
    # Johansson: the zeros of P+ stand at 0.013 and −0.057 rad/s.
    assert float(row.computed) == pytest.approx(0.013, abs=5e-4)


def test_the_figures_that_the_text_describes_are_drawn(findings):
    numbers = [figure.number for found in findings.values() for figure in found.figures]
    assert [number for number in numbers if number] == ["Fig. 3", "Fig. 4", "Fig. 5", "Fig. 6"]
    assert numbers.count("") == 4


def test_the_plant_is_johanssons():
    """Table I: γ, k, and the equilibrium of 3 V by hand from it."""
    process = plant()
    values = {p.name: p.initial for p in process.parameters}
    assert values["splitter_1.tank_1"] == 0.70
    assert values["pump_2.gain"] == pytest.approx(3.35e-6)
    at = at_target().operating_point.as_dict()
    # a3 √(2 g h3) = (1 − γ2) k2 v2 at rest.
    h3 = (0.40 * 3.35 * at["pump_2"] / 0.071) ** 2 / (2 * 981.0) / 100.0
    assert at["tank_3.level"] == pytest.approx(h3, rel=1e-9)


def test_the_sampling_is_fine_enough(monkeypatch):
    """Half the sampling period moves overshoot and settling by less than is told."""
    usual = rig.fill(rig.in_volts("variable_structure"))
    finer = dataclasses.replace(plant(), sampling_period=plant().sampling_period / 2)
    wanted = {f"level_{j}": 50.0 * level for j, level in enumerate(rig.TARGET, start=1)}
    monkeypatch.setattr(rig, "at_target", lambda: analyse(finer, outputs=wanted))
    found = rig.fill(rig.in_volts("variable_structure"))
    assert found.time[1] - found.time[0] == pytest.approx(0.05)
    for tank in (1, 2):
        assert found.overshoot(tank) == pytest.approx(usual.overshoot(tank), abs=0.05)
        assert found.settling(tank) == pytest.approx(usual.settling(tank), abs=0.3)
        assert found.rise(tank) == pytest.approx(usual.rise(tank), abs=0.1)
