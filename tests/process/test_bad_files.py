"""Process files with one mistake each: one message, with line, path, value and remedy."""

import random
import tomllib
from pathlib import Path

import pytest

import clepsydra as cl
from clepsydra import InputError
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process

VALID = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
CATALOGUE = ", ".join(catalogue_names())

# What is replaced in the valid file, by what, and the message after the file's name.
EDITS = [
    edit
    for path in sorted(Path(__file__).parent.glob("bad_*.toml"))
    for edit in tomllib.loads(path.read_text(encoding="utf-8"))["edit"]
]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def message_for(content: str | bytes) -> str:
    """Write a process file, read it, and return the one message that comes of it."""
    encoded = content.encode() if isinstance(content, str) else content
    Path("plant.toml").write_bytes(encoded)
    with pytest.raises(InputError) as caught:
        load_process("plant.toml")
    message = str(caught.value)
    assert message.isprintable()
    return message


def test_the_file_without_a_mistake() -> None:
    Path("plant.toml").write_text(VALID, encoding="utf-8")
    process = load_process("plant.toml")
    assert process.path == Path("plant.toml")
    assert [signal.name for signal in process.state] == ["tank_1.level", "tank_2.level"]


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit["by"][:60])
def test_one_edit(edit: dict[str, str]) -> None:
    assert edit["replace"] in VALID
    content = VALID.replace(edit["replace"], edit["by"], 1)
    assert message_for(content) == f"plant.toml, {edit['message']}"


def test_every_mistake_is_another_one() -> None:
    assert len(EDITS) >= 200
    assert len({(edit["replace"], edit["by"]) for edit in EDITS}) == len(EDITS)
    assert len({edit["message"].partition(": got")[2] for edit in EDITS}) > 150


def test_a_delay_of_no_number_of_steps_is_refused_in_a_simulation() -> None:
    """Which steps there are is known only with the loop; the linear model takes any delay."""
    stream = 'fractions = { tank_1 = 0.7, pipe = 0.3 }\n[delays.pipe]\ndestination = "tank_2"\n'
    for time in ("3.14159 s", "1e-12 s"):
        text = VALID.replace(
            'fractions = { tank_1 = 0.7, tank_2 = "30 %" }', f'{stream}time = "{time}"'
        )
        Path("plant.toml").write_text(text, encoding="utf-8")
        plant = cl.load("plant.toml")
        assert plant.linear.states
        with pytest.raises(InputError) as caught:
            cl.study(plant)
        assert str(caught.value) == (
            f"plant, pipe.delayed_flow, time: got '{time}', expected a multiple of an integration "
            "step of at least 0.0001 s, which is a whole part of the sampling period of 1 s; round "
            "the delay or change the sampling period."
        )


def test_operating_level_above_the_rim() -> None:
    text = VALID.replace('nominal = "3 V"', '[operating_point]\nlevel_1 = "12 V"')
    text = text.replace(
        'gain = "0.5 V/cm"\nrange = ["0 V", "10 V"]', 'gain = "0.5 V/cm"\nrange = ["0 V", "15 V"]'
    )
    assert message_for(text) == (
        "plant.toml, line 34, operating_point.level_1: got '12 V', expected a level above the "
        "floor and below the rim of tank_1, at most 10 V; lower it, or correct the height of the "
        "tank."
    )


def test_two_values_for_one_level() -> None:
    text = VALID.replace('nominal = "3 V"', '[operating_point]\nlevel_1 = "6 V"\nagain = "12 cm"')
    text += '[sensors.again]\ntank = "tank_1"\nrange = ["0 cm", "20 cm"]\n'
    assert message_for(text) == (
        "plant.toml, line 34, operating_point.level_1: got '6 V', expected one value for tank_1; "
        "remove one of the two."
    )


@pytest.mark.parametrize(
    ("kept", "message"),
    [
        ("", "no tanks, expected at least one tank; add a table, as in [tanks.tank_1]."),
        (
            "tanks",
            "no pumps, expected at least one pump, or a flow that is manipulated; add a table, as "
            "in [pumps.pump_1].",
        ),
        (
            "tanks reservoirs pumps",
            "no sensors, expected at least one sensor; add a table, as in [sensors.sensor_1].",
        ),
    ],
)
def test_nothing_to_control(kept: str, message: str) -> None:
    head, *tables = VALID.split("\n[")
    text = head + "".join(f"\n[{table}" for table in tables if table.split(".")[0] in kept.split())
    assert message_for(text) == f"plant.toml, line 1: got {message}"


@pytest.mark.parametrize(
    ("text", "start"),
    [
        (VALID.replace('area = "28 cm^2"', 'area "28 cm^2"'), "line 10: got 'area \"28 cm^2\"'"),
        (VALID[: VALID.index('cm"]')], "line 51: got 'range = [\"0 cm\", \"20'"),
        (VALID[: VALID.index("ks.tank_2]")], "line 13: got '[tan'"),
        ("\0" * 100, "line 1: got '" + "\\x00" * 60 + "…'"),
        ("{}", "line 1: got '{}'"),
    ],
)  # fmt: skip
def test_no_toml(text: str, start: str) -> None:
    """Cut off, or not in the notation: the words in brackets are those of the parser."""
    message = message_for(text)
    assert message.startswith(f"plant.toml, {start}, expected valid TOML (")
    assert message.endswith("); correct the line, or see whether the file is cut off.")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "plant.toml: got an empty file, expected a process; begin with one that clepsydra "
         "new NAME writes."),
        (b" \n\n", "plant.toml: got an empty file, expected a process; begin with one that "
         "clepsydra new NAME writes."),
        (b"\x7fELF\x02\n\xff", "plant.toml, line 2: got byte 0xff, expected text in UTF-8; check "
         "that this is a process file, and save it as UTF-8."),
        (VALID.encode("utf-16"), "plant.toml, line 1: got byte 0xff, expected text in UTF-8; "
         "check that this is a process file, and save it as UTF-8."),
        (b"#\n" * 600_000, "plant.toml: got more than 1 MB, expected a process file of at most "
         "1 MB; check that this is the file you mean."),
        (b"a." * 5000 + b"b = 1", "plant.toml, line 1: got 10005 characters, expected a line of "
         "at most 1000 characters; break the line."),
        (b"x = " + b"[" * 990, "plant.toml: got brackets in brackets without end, expected a "
         "process file; check the brackets."),
        (b"x = " + b"[\n" * 400_000, "plant.toml: got brackets in brackets without end, expected "
         "a process file; check the brackets."),
    ],
)  # fmt: skip
def test_content(content: bytes, message: str) -> None:
    assert message_for(content) == message


def test_byte_order_mark_and_windows_line_ends_are_read() -> None:
    Path("plant.toml").write_bytes(b"\xef\xbb\xbf" + VALID.replace("\n", "\r\n").encode())
    assert load_process("plant.toml").title == "Two tanks in series"
    text = VALID.replace('area = "28 cm^2"', "area = 28").replace("\n", "\r\n")
    assert message_for(text).startswith("plant.toml, line 10, tanks.tank_1.area: got 28, ")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.toml", "none.toml: got no such file, expected a process file; check the path."),
        (
            "folder.toml",
            "folder.toml: got a folder, expected a process file; name the .toml file in it.",
        ),
        (
            Path("quadruple-tank"),
            "quadruple-tank: got no such file, expected a process file; check the path.",
        ),
        (
            "quadrupel-tank",
            f"process: got 'quadrupel-tank', expected a name of the catalogue ({CATALOGUE}) or the "
            "path of a .toml file; "
            "perhaps 'quadruple-tank' was meant.",
        ),
        (
            "",
            f"process: got '', expected a name of the catalogue ({CATALOGUE}) or the path of a "
            ".toml file; "
            "choose a name, or check the path.",
        ),
    ],
)
def test_no_file(name: str | Path, message: str) -> None:
    Path("folder.toml").mkdir()
    with pytest.raises(InputError) as caught:
        load_process(name)
    assert str(caught.value) == message


@pytest.mark.parametrize("name", ["a\0b.toml", "x" * 5000 + ".toml", "/dev/null", "q" * 100_000])
def test_strange_path(name: str) -> None:
    with pytest.raises(InputError):
        load_process(name)


@pytest.mark.thorough
def test_damaged_at_random() -> None:
    """Lines lost, doubled, exchanged, characters overwritten: a process or one message."""
    generator = random.Random(1)
    refused = 0
    for _ in range(400):
        lines = VALID.split("\n")
        for _ in range(generator.randint(1, 3)):
            first, second = generator.randrange(len(lines)), generator.randrange(len(lines))
            damage = generator.randrange(4)
            if damage == 0:
                lines[first] = ""
            elif damage == 1:
                lines.insert(second, lines[first])
            elif damage == 2:
                lines[first], lines[second] = lines[second], lines[first]
            elif lines[first]:
                at = generator.randrange(len(lines[first]))
                other = generator.choice("\"'[]{}=.,#0-9 e\\\x00é\t")
                lines[first] = lines[first][:at] + other + lines[first][at + 1 :]
        Path("plant.toml").write_text("\n".join(lines), encoding="utf-8")
        try:
            load_process("plant.toml")
        except InputError as error:
            refused += 1
            assert str(error).startswith("plant.toml")
            assert str(error).isprintable()
    assert 200 < refused < 400


def test_any_extension() -> None:
    Path("plant.txt").write_text(VALID, encoding="utf-8")
    assert load_process("plant.txt").name == "plant"
    assert load_process(Path("plant.txt")).name == "plant"


@pytest.mark.parametrize(
    ("value", "shown"), [(3, "3"), (None, "None"), (b"a.toml", "'a bytes'"), ([], "'a list'")]
)
def test_what_is_neither_name_nor_path(value, shown):
    with pytest.raises(InputError) as refusal:
        load_process(value)
    assert str(refusal.value) == (
        f"process: got {shown}, expected a name of the catalogue ({CATALOGUE}) or the path of a "
        ".toml file; "
        "give it as text or as a Path."
    )
