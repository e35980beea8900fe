"""Variants of a process file: which are in force, what they change, and where mistakes stand."""

import math
from pathlib import Path

import pytest

from clepsydra import InputError
from clepsydra.process.reader import load_process

VALID = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
VARIANTS = """
[variants.wide]
description = "Wider tanks"
tanks.tank_1.area = "50 cm^2"
tanks.tank_2.area = "60 cm^2"

[variants.high.tanks.tank_1]
height = "40 cm"

[variants.half]
splitters.valve.fractions = { tank_1 = 0.5, tank_2 = 0.5 }
pumps.pump_1.range = ["1 V", "9 V"]

[variants.third]
sampling_period = "2 s"
controlled = ["level_2"]

[variants.third.tanks.tank_3]
area = "10 cm^2"
height = "10 cm"

[variants.third.orifices.outlet_3]
source = "tank_3"
destination = "tank_2"
area = "0.05 cm^2"
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(VALID + VARIANTS)


def write(text: str) -> None:
    Path("plant.toml").write_text(text, encoding="utf-8")


def values(process, *names: str) -> list[float]:
    return [process.signal(name).initial for name in names]


def refusal(name: object = "plant.toml", variant: object = None) -> str:
    with pytest.raises(InputError) as caught:
        load_process(name, variant)
    return str(caught.value)


def test_without_variants_the_file_is_as_it_stands() -> None:
    process = load_process("plant.toml")
    assert process.variant == ()
    assert dict(process.variants) == {"wide": "Wider tanks", "high": "", "half": "", "third": ""}
    write(VALID)
    plain = load_process("plant.toml")
    assert list(plain.parameter_values) == list(process.parameter_values)
    assert dict(plain.variants) == {}


def test_a_variant_changes_what_it_names_and_nothing_else() -> None:
    process = load_process("plant.toml", "wide")
    assert values(process, "tank_1.area", "tank_2.area") == [50e-4, 60e-4]
    plain = load_process("plant.toml")
    for one, other in zip(plain.parameters, process.parameters, strict=True):
        assert one.name == other.name
        assert (one.initial == other.initial) == (one.name not in ("tank_1.area", "tank_2.area"))
    # The next process that is read from the file does not remember it.
    assert values(load_process("plant.toml"), "tank_1.area") == [28e-4]


def test_tables_are_merged_and_lists_replaced() -> None:
    process = load_process("plant.toml", ["high", "half"])
    assert process.signal("tank_1.level").high == 0.4
    assert values(process, "tank_1.area", "valve.tank_1") == [28e-4, 0.5]
    assert (process.inputs[0].low, process.inputs[0].high, process.inputs[0].initial) == (1, 9, 3)


def test_a_variant_may_bring_elements_and_general_keys() -> None:
    process = load_process("plant.toml", "third")
    assert [signal.name for signal in process.state] == [f"tank_{i}.level" for i in (1, 2, 3)]
    assert (process.controlled, process.sampling_period) == (("level_2",), 2.0)


def test_later_variants_win() -> None:
    write(VALID + VARIANTS + '\n[variants.narrow]\ntanks.tank_1.area = "5 cm^2"\n')
    assert values(load_process("plant.toml", ("wide", "narrow")), "tank_1.area") == [5e-4]
    assert values(load_process("plant.toml", ("narrow", "wide")), "tank_1.area") == [50e-4]


def test_an_area_takes_the_place_of_a_diameter_and_the_other_way_round() -> None:
    round_ones = (
        '\n[variants.round]\ntanks.tank_1.diameter = "10 cm"\norifices.outlet_1.diameter = "4 mm"\n'
    )
    write(VALID + VARIANTS + round_ones)
    names = "tank_1.area", "outlet_1.area"
    areas = [math.pi * 25e-4, math.pi * 4e-6]
    assert values(load_process("plant.toml", "round"), *names) == pytest.approx(areas)
    assert values(load_process("plant.toml", ("wide", "round")), *names) == pytest.approx(areas)
    later = values(load_process("plant.toml", ("round", "wide")), *names)
    assert later == pytest.approx([50e-4, areas[1]])


def test_a_default_variant_says_that_the_area_of_the_file_has_no_effect() -> None:
    line = VALID[: VALID.index('area = "28 cm^2"')].count("\n") + 2
    write('default_variant = "round"\n' + VALID + '\n[variants.round.tanks]\n'
          'tank_1.diameter = "10 cm"\n')  # fmt: skip
    (warning,) = load_process("plant.toml").warnings
    assert f"tanks.tank_1.area (line {line}) of plant.toml has no effect" in warning


def test_a_variant_gives_either_an_area_or_a_diameter() -> None:
    write(VALID + '\n[variants.both.tanks.tank_1]\narea = "9 cm^2"\ndiameter = "10 cm"\n')
    assert "variants.both.tanks.tank_1.diameter: " in refusal(variant="both")


def test_a_tank_called_area_has_no_area_in_its_place() -> None:
    named = VALID.replace("tank_1", "area").replace("tank_2", "diameter")
    write(named + "\n[variants.same.splitters.valve.fractions]\narea = 0.7\n")
    assert values(load_process("plant.toml", "same"), "valve.area") == [0.7]


def test_variants_after_a_colon() -> None:
    process = load_process("plant.toml:wide, half")
    assert process.variant == ("wide", "half")
    assert process.path == Path("plant.toml")
    assert values(process, "tank_1.area", "valve.tank_1") == [50e-4, 0.5]
    assert load_process(str(Path("plant.toml").absolute()) + ":wide").variant == ("wide",)
    # A file may have such a name itself.
    Path("odd:wide").write_text(VALID, encoding="utf-8")
    assert load_process("odd:wide").variant == ()


def test_default_variants() -> None:
    for default, expected in (('"wide"', ("wide",)), ('["high", "half"]', ("high", "half"))):
        write(f"default_variant = {default}\n{VALID}{VARIANTS}")
        assert load_process("plant.toml").variant == expected
        assert load_process("plant.toml", "third").variant == ("third",)
        assert load_process("plant.toml", ()).variant == ()


@pytest.mark.parametrize(
    ("name", "variant", "message"),
    [
        ("plant.toml:wode", None, "variant: got 'wode', expected a variant of plant.toml "
         "(wide, high, half, third); perhaps 'wide' was meant."),
        ("plant.toml", "x", "variant: got 'x', expected a variant of plant.toml (wide, high, half, "
         "third); choose one of them, or none."),
        ("plant.toml", ("wide", "wide"), "variant: got 'wide', expected every variant once; remove "
         "one of the two."),
        ("plant.toml:wide", "half", "variant: got 'half', expected no variant beside wide, which "
         "follows the colon; give variants in one of the two ways."),
        ("plant.toml:wide,", None, "process: got 'plant.toml:wide,', expected a variant after the "
         "colon and after each comma; write as in \"plant.toml:variant\", or leave the colon out."),
        ("plant.toml", 3, "variant: got 3, expected the name of a variant, or several names; write "
         'as in variant="fitted" or variant=["fitted", "volts"].'),
        ("quadruple-tank:wide", None, "variant: got 'wide', expected no variant, "
         "since quadruple-tank.toml has none; leave it out."),
        ("none.toml:wide", None, "none.toml: got no such file, expected a process file; check "
         "the path."),
    ],
)  # fmt: skip
def test_what_cannot_be_chosen(name: str, variant: object, message: str) -> None:
    assert refusal(name, variant) == message


@pytest.mark.parametrize(
    ("added", "asked", "message"),
    [
        ('variants.v.tanks.tank_1.area = 28', "v", "line 2, variants.v.tanks.tank_1.area: got 28, "
         "expected "),
        ('variants.v.tanks.tank_1.aera = "1 m^2"', "v", "line 2, variants.v.tanks.tank_1.aera: got "
         "'aera', expected one of "),
        ('variants.v.tanks.tank_9.area = "1 m^2"', "v", "line 2, variants.v.tanks.tank_9"),
        ('variants.v.contrlled = ["level_1"]', "v", "line 2, variants.v.contrlled: got "
         "'contrlled', expected one of "),
        ('variants.v.splitters.valve.fractions.tank_1 = "seven"', "v", "line 2, "
         "variants.v.splitters.valve.fractions.tank_1: got 'seven', expected "),
        ('variants.v.tanks = 3', "v", "line 2, variants.v.tanks: got 3, expected a table; "),
        ('variants.v.name = "other"', None, "line 2, variants.v.name: got 'other', expected no "
         "name within a variant; remove it, or move it to the top of the file."),
        ('variants.v.variants.w.title = "x"', "v", "line 2, variants.v.variants: got "),
        ('variants.v.description = 3', None, "line 2, variants.v.description: got 3, expected one "
         "line of text; correct it."),
        ('variants.v = 3', None, "line 2, variants.v: got 3, expected a table; write "
         "[variants.v]."),
        ('variants = 3', None, "line 2, variants: got 3, expected a table; write [variants]."),
        ('variants."a,b".title = "x"', None, "line 2, variants.a,b: got 'a,b', expected letters, "
         "digits and single hyphens after a first letter; write as in "),
        ('default_variant = "v"', None, "line 2, default_variant: got 'v', expected no variant, "
         "since plant.toml has none; leave it out."),
        ('default_variant = 3', None, "line 2, default_variant: got 3, expected the name of a "
         "variant; write as in "),
        ('defualt_variant = "v"', None, "line 2, defualt_variant: got 'defualt_variant', expected "
         "one of "),
    ],
)  # fmt: skip
def test_mistakes_in_variants(added: str, asked: str | None, message: str) -> None:
    first, rest = VALID.split("\n", 1)
    write(f"{first}\n{added}\n{rest}")
    assert refusal(variant=asked).startswith(f"plant.toml, {message}")


def test_places_beside_a_variant_stay_those_of_the_file() -> None:
    line = VALID[: VALID.index('area = "0.071 cm^2"')].count("\n") + 1
    write(VALID.replace('"0.071 cm^2"', '"0.071 cm"') + VARIANTS)
    place = f"plant.toml, line {line}, orifices.outlet_1.area: "
    assert refusal().startswith(place)
    assert refusal(variant=["wide", "third"]).startswith(place)
