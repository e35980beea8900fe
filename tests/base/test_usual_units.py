"""The usual units, read at once, are those of Pint to the last digit of an exact fraction."""

import subprocess
import sys
from fractions import Fraction
from itertools import product

import pint
import pytest

from clepsydra.base.usual_units import FLOWS, Unit, usual_unit, usual_units

BASE = ("meter", "kilogram", "second", "ampere", "mole")


@pytest.fixture(scope="module")
def registry() -> pint.UnitRegistry:
    return pint.UnitRegistry(non_int_type=Fraction)


def by_pint(registry: pint.UnitRegistry, text: str) -> Unit:
    found = registry.Quantity(Fraction(1), registry.Unit(text)).to_base_units()
    powers = {str(name): int(power) for name, power in found.unit_items()}
    assert set(powers) <= set(BASE)
    return Unit(Fraction(found.magnitude), tuple(powers.get(name, 0) for name in BASE))


def test_every_name_is_the_same_unit_for_pint(registry) -> None:
    named = usual_units()
    assert {"µm", "ml", "kV", "litres", "decimeter", "mmol"} <= set(named) and "cd" not in named
    flows = {name for names in FLOWS for name in names.split()}
    known = {name: unit for name, unit in named.items() if name not in flows}
    wrong = [name for name, unit in known.items() if unit != by_pint(registry, name)]
    assert not wrong


@pytest.mark.parametrize(
    ("flow", "text"),
    [
        ("gpm", "gallon/minute"), ("MGD", "megagallon/day"), ("lpm", "liter/minute"),
        ("cfm", "foot^3/minute"), ("cfs", "foot^3/second"),
    ],
)  # fmt: skip
def test_a_flow_in_a_word_is_what_it_stands_for(flow, text, registry) -> None:
    assert usual_unit(flow) == by_pint(registry, text)


SHAPES = (
    "{}/{} {}", "{}/({} {})", "{}/{}/{}", "1/({} {})/{}", "{} / ({}/{})", "{}*({} / {})",
    "({}) {} ({})", "{}^2 {}**-1/{}^3", "{}/(({}) {}^2)", "{} · ({})/{}", "1 / {} ** 2 {} {}",
)  # fmt: skip


@pytest.mark.parametrize("shape", SHAPES)
def test_products_are_the_same_for_pint(shape, registry) -> None:
    for names in product(("cm", "l", "%"), ("s", "min"), ("mV", "kmol")):
        text = shape.format(*names)
        assert usual_unit(text) == by_pint(registry, text)


def test_the_number_one_is_a_unit_and_nothing_else_without_one() -> None:
    assert usual_unit("1") == Unit(Fraction(1), (0, 0, 0, 0, 0))
    assert usual_unit("1/1") is usual_unit("") is usual_unit("2 m") is None


@pytest.mark.parametrize(
    "text",
    ["yard", "cmm", "m^0", "m^", "m^23", "m s)", "(m", "()", "m /", "/ s", "* m", "m//s", "m^+2",
     "V(s)", "m.s", "m 1", "m + m", "degC"],
)  # fmt: skip
def test_what_is_not_usual_is_left_to_pint(text) -> None:
    assert usual_unit(text) is None


def test_a_usual_unit_is_read_and_one_of_another_kind_refused_without_pint() -> None:
    script = (
        "import sys; from clepsydra.base.units import convertible, to_si\n"
        "assert to_si('3.6 m^3/h', 'm^3/s', '') == 0.001 and not convertible('l', 'm')\n"
        "assert 'pint' not in sys.modules\n"
        "assert to_si('1 yard', 'm', '') == 0.9144 and 'pint' in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
