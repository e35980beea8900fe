"""Damaged and invented process files: a process or one message, and never anything else."""

import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clepsydra import ClepsydraError, InputError
from clepsydra.linear.analysis import analyse
from clepsydra.process import reader
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.document import parse
from clepsydra.process.kinds import kinds
from clepsydra.process.process import Process

FIXED = settings(
    derandomize=True,
    database=None,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)

HERE = Path(__file__).parent
GOOD = [
    *(catalogue_file(name).read_text(encoding="utf-8") for name in catalogue_names()),
    (HERE / "plant.toml").read_text(encoding="utf-8"),
    (HERE.parent / "one-tank.toml").read_text(encoding="utf-8"),
]

#: Parts of a file that may be exchanged for others of their sort.
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
UNIT = re.compile(r"(?<=\d )[A-Za-z%][^\"]*")
VALUE = re.compile(r"(?<== ).+$", re.MULTILINE)
WORD = re.compile(r"[a-z]+(?:_[0-9a-z]+)*")

NUMBERS = (
    "0", "-1", "1", "1e-300", "1e300", "1e-12", "1e12", "1e999", "nan", "inf", "-0.0", "0.5",
    "100", "99999999999999999999", "1_000", "0x10", "1e", "1.5.2", "３", "½",
)  # fmt: skip
UNITS = (
    "m", "cm", "mm", "m^2", "cm^2", "m^3", "l", "m^3/s", "l/h", "cm^3/(s V)", "V", "mA", "%",
    "bar", "s", "min", "h", "Hz", "kg/m^3", "mol/l", "mm/day", "m^2/s", "", "m^^2", "(", "m/0",
    "degC", "delta_degC", "m**1000", "dB", "1/min", "m^2 s", "kelvin", "3 m", "é", "m;m",
)  # fmt: skip
VALUES = (
    "0", "1", "-1", "true", "false", "nan", "inf", '""', '"tank_1"', '"1 m"', '"1"', "[]", "{}",
    '["0 m", "1 m"]', "[[]]", '[["0 m", "1 m^2"], ["1 m", "2 m^2"]]', "[0, 1]", "[true]",
    '{ tank_1 = 1 }', '{ tank_1 = "5 cm" }', "1979-05-27", "07:32:00", "1979-05-27T07:32:00Z",
    "'''\na\n'''", '"\\u0000"', '"\\uFFFF"', "9" * 400, "[[[[[[[[]]]]]]]]", '{ a = { b = [{}] } }',
)  # fmt: skip

#: Words that mean something in a process file.
KEYS = sorted(
    {key for kind in kinds() for key in kind.keys}
    | {kind.table for kind in kinds()}
    | set(reader.GENERAL_KEYS)
    | {"tank_1", "tank_2", "basin", "pump_1", "level_1", "salt"}
)


def written(value: Any) -> str:
    """Write a value in TOML's notation."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        text = "".join(
            c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08x}" for c in value
        )
        return f'"{text}"'
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    return "{ " + ", ".join(f"{written(k)} = {written(v)}" for k, v in value.items()) + " }"


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    """A good file with a few things done to it."""
    text = draw(st.sampled_from(GOOD))
    for _ in range(draw(st.integers(1, 4))):
        lines = text.split("\n")
        first = draw(st.integers(0, len(lines) - 1))
        second = draw(st.integers(0, len(lines) - 1))
        match draw(st.integers(0, 9)):
            case 0:
                del lines[first]
                text = "\n".join(lines)
            case 1:
                text = "\n".join([*lines[:second], lines[first], *lines[second:]])
            case 2:
                lines[first], lines[second] = lines[second], lines[first]
                text = "\n".join(lines)
            case 3:
                text = exchanged(draw, text, NUMBER, st.sampled_from(NUMBERS))
            case 4:
                text = exchanged(draw, text, UNIT, st.sampled_from(UNITS))
            case 5:
                text = exchanged(draw, text, VALUE, st.sampled_from(VALUES))
            case 6:
                text = exchanged(draw, text, WORD, st.sampled_from(KEYS))
            case 7:
                text = exchanged(draw, text, VALUE, st.just(draw(st.sampled_from(lines))))
            case 8:
                text = text[: draw(st.integers(0, len(text)))]
            case 9:
                at = draw(st.integers(0, len(text)))
                text = text[:at] + draw(st.text(max_size=8)) + text[at:]
    content = text.encode("utf-8", "surrogatepass")
    if draw(st.integers(0, 9)) == 0:
        at = draw(st.integers(0, len(content)))
        content = content[:at] + draw(st.binary(max_size=4)) + content[at:]
    return content


def exchanged(draw: st.DrawFn, text: str, part: re.Pattern[str], by: st.SearchStrategy[str]) -> str:
    found = list(part.finditer(text))
    if not found:
        return text
    match = found[draw(st.integers(0, len(found) - 1))]
    return text[: match.start()] + draw(by) + text[match.end() :]


def plausible() -> st.SearchStrategy[Any]:
    quantities = st.builds("{} {}".format, st.sampled_from(NUMBERS), st.sampled_from(UNITS))
    leaves = (
        quantities
        | st.sampled_from(KEYS)
        | st.text(max_size=5)
        | st.booleans()
        | st.integers(-(10**20), 10**20)
        | st.floats().filter(math.isfinite)
    )
    return st.recursive(
        leaves,
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=3), inner, max_size=3)
        ),
        max_leaves=4,
    )


@st.composite
def invented(draw: st.DrawFn) -> bytes:
    """A file of tables with known and unknown keys and any values, half of them begun well."""
    general = [f"{written(key)} = {written(draw(plausible()))}" for key in draw(keys_of(KEYS, 2))]
    if draw(st.booleans()):
        general += ['name = "plant"', 'sampling_period = "1 s"', 'controlled = ["level_1"]']
    tables = []
    for kind in draw(st.lists(st.sampled_from(kinds()), max_size=4, unique=True)):
        tables.append(f"[{kind.table}.{draw(st.sampled_from(KEYS))}]")
        keys = draw(keys_of(kind.keys, 5))
        tables += [f"{key} = {written(draw(plausible()))}" for key in keys]
    whole = draw(st.sampled_from(GOOD)) if draw(st.integers(0, 4)) == 0 else ""
    return "\n".join([*general, whole, *tables]).encode("utf-8", "surrogatepass")


def keys_of(keys: Any, most: int) -> st.SearchStrategy[list[str]]:
    return st.lists(st.sampled_from(sorted(keys)), max_size=most, unique=True)


def read(content: bytes, folder: Path) -> Process | None:
    """Read a file; whatever is wrong with it is said in one line that names the file."""
    path = folder / "plant.toml"
    path.write_bytes(content)
    try:
        return reader.load_process(path)
    except InputError as error:
        assert str(error).startswith(str(path))
        assert str(error).isprintable()
        assert len(str(error)) < 2000
        return None


def examine(process: Process | None) -> None:
    """Analyse what could be read: a result in finite numbers, or a message."""
    if process is None:
        return
    try:
        analysis = analyse(process)
    except ClepsydraError as error:
        assert str(error).isprintable()
    else:
        for value in analysis.operating_point.as_dict().values():
            assert math.isfinite(value)


@pytest.mark.thorough
@settings(FIXED, max_examples=100)
@given(damaged())
def test_a_damaged_file_is_read_or_refused(tmp_path: Path, content: bytes) -> None:
    examine(read(content, tmp_path))


@pytest.mark.thorough
@settings(FIXED, max_examples=100)
@given(invented())
def test_an_invented_file_is_read_or_refused(tmp_path: Path, content: bytes) -> None:
    examine(read(content, tmp_path))


@settings(FIXED, max_examples=200)
@given(st.binary(max_size=200) | st.text(max_size=200).map(lambda t: t.encode("utf-8", "replace")))
def test_no_file_of_ours_at_all(tmp_path: Path, content: bytes) -> None:
    assert read(content, tmp_path) is None


@pytest.mark.thorough
@settings(FIXED, max_examples=200)
@given(st.dictionaries(st.sampled_from(KEYS) | st.text(max_size=3), plausible(), max_size=4))
def test_every_key_has_a_line(tables: dict[str, Any]) -> None:
    """What this file writes is TOML, and the line of each key is the one that it stands on."""
    text = "\n".join(f"{written(key)} = {written(value)}" for key, value in tables.items())
    assert tomllib.loads(text) == tables
    if tables:
        lines = parse(text.encode(), "plant.toml").lines
        assert {key: lines[(key,)] for key in tables} == {
            key: number for number, key in enumerate(tables, 1)
        }
