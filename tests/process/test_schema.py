"""The schema for editors knows every file of the catalogue, and refuses what the reader does."""

import json
import re
import subprocess
import sys
import tomllib

import pytest
from json_schema import faults

from clepsydra import InputError
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.declared import Quantity, declared
from clepsydra.process.document import Document
from clepsydra.process.kinds import kinds
from clepsydra.process.schema import process_schema
from clepsydra.process.table_reader import TableReader
from clepsydra.process.vessels.reading import SHAPES

SCHEMA = process_schema()


@pytest.mark.parametrize("name", catalogue_names())
def test_it_fits_the_catalogue(name: str) -> None:
    tables = tomllib.loads(catalogue_file(name).read_text(encoding="utf-8"))
    assert list(faults(tables, SCHEMA)) == []
    assert set(tables) <= set(SCHEMA["properties"])


WHOLE = tomllib.loads(catalogue_file("equalisation-tank").read_text(encoding="utf-8"))
WHOLE = {key: value for key, value in WHOLE.items() if "variant" not in key}


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("valves",), {"v": {"characteristic": "odd"}}),
        (("valvs",), {}),
        (("sampling_period",), None),
        (("sensors", "level", "range"), None),
        (("sensors", "level", "range"), ["0 m"]),
        (("sensors", "level", "lagg"), "1 s"),
        (("sensors", "level", "lag"), 3),
        (("tanks", "basin", "shape"), "cone"),
        (("tanks", "basin", "area"), None),
        (("tanks", "basin", "height"), None),
        (("tanks", "basin", "height"), "-5 m"),
        (("tanks", "basin", "height"), "0 m"),
        (("tanks", "basin", "height"), "5 m^2"),
        (("tanks", "basin", "area"), "1000 m"),
        (("tanks", "basin", "area"), "1000"),
        (("tanks", "basin", "area"), "1,5 m^2"),
        (("sensors", "level", "lag"), "28 cm"),
        (("flows", "inflow", "range"), ["0 m", "1 m"]),
        (("flows", "inflow", "step"), ["0.1 m^3/s", "1 s"]),
        (("tanks", "basin", "table"), [["0 m^2", "1 m"]]),
        (("pumps",), {"p": {"source": "a", "destination": "b", "range": ["0 V", "1 V"],
                            "curve": [["0 l/s", "1 m"]], "static_head": "1 m",
                            "trip_above": {"basin": "3 s"}, "hysteresis": "1 cm"}}),
        (("pumps",), {"p": {"source": "a", "destination": "b", "range": ["0 V", "1 V"]}}),
        (("pumps",), {"p": {"source": "a", "destination": "b", "range": ["0 V", "1 V"],
                            "curve": [["0 l/s", "1 m"]]}}),
    ],
)  # fmt: skip
def test_it_refuses_what_is_wrong(path: tuple[str, ...], value: object) -> None:
    tables = json.loads(json.dumps(WHOLE))
    assert list(faults(tables, SCHEMA)) == []
    *above, last = path
    table = tables
    for key in above:
        table = table[key]
    if value is None:
        del table[last]
    else:
        table[last] = value
    assert len(list(faults(tables, SCHEMA))) >= 1


NUMBERS = ("1", "0", "-2", "3e-1", ".5", "5e3", "1e", "1,5")
UNITS = "% cm m^2 mm² acre m^3 l gal m^3/s l/min gal/min s h 1/s /h Hz V mA kg/m^3 mol/l 1/V W odd"
VALUES = [f"{n}{space}{unit}" for n in NUMBERS for space in ("", " ") for unit in UNITS.split()]
VALUES += [*NUMBERS, "1 m^3/(s V)", -1, 0, 0.5, 1, 1.5, 7]


@pytest.mark.parametrize("owner", [*kinds(), *SHAPES], ids=lambda owner: owner.__name__)
def test_it_refuses_only_what_the_reader_refuses(owner: type) -> None:
    for each in (each for each in declared(owner).values() if isinstance(each, Quantity)):
        unit, told = (
            each.unit_of(dict.fromkeys(re.findall(r"{(\w+)}", each.unit), "V")),
            each.schema(),
        )
        low = {"above" if each.strict else "at_least": each.low}
        wrong = [value for value in VALUES if any(faults(value, told))]
        for value in wrong:
            table = TableReader(Document("plant.toml", {"it": value}, {}), (), None)
            with pytest.raises(InputError):
                table.quantity("it", unit, "it", "correct it", at_most=each.high, **low)
        assert {"1,5 m^2", "1e", "1e V"} <= {*wrong}
        assert ("-2 1/V" in wrong) == (each.low >= 0.0)
        assert ("1 cm" in wrong) == (unit == each.unit != "m")


def test_it_has_every_key() -> None:
    for kind in kinds():
        table = SCHEMA["properties"][kind.table]["additionalProperties"]
        assert tuple(table["properties"]) == kind.keys


def test_the_command_prints_it() -> None:
    command = [sys.executable, "-m", "clepsydra", "processes", "--schema"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert json.loads(shown) == SCHEMA
