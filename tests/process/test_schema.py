"""The schema for editors knows every file of the catalogue, and refuses what the reader does."""

import json
import subprocess
import sys
import tomllib

import pytest
from json_schema import faults

from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.kinds import kinds
from clepsydra.process.schema import process_schema

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


def test_it_has_every_key() -> None:
    for kind in kinds():
        table = SCHEMA["properties"][kind.table]["additionalProperties"]
        assert tuple(table["properties"]) == kind.keys


def test_the_command_prints_it() -> None:
    command = [sys.executable, "-m", "clepsydra", "processes", "--schema"]
    shown = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert json.loads(shown) == SCHEMA
