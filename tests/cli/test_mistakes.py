"""A newcomer's mistakes: one message each, with place and remedy, and nothing half-written."""

import pytest

INTEGRATING = """
name = "buffer"
sampling_period = "1 s"
controlled = ["level"]
manipulated = ["outflow"]
[tanks.tank]
area = "1 m^2"
height = "2 m"
[flows.inflow]
destination = "tank"
range = ["0 m^3/h", "10 m^3/h"]
nominal = "5 m^3/h"
[flows.outflow]
source = "tank"
range = ["0 m^3/h", "10 m^3/h"]
nominal = "5 m^3/h"
[sensors.level]
tank = "tank"
range = ["0 m", "2 m"]
"""
UNLISTED = INTEGRATING.replace('manipulated = ["outflow"]\n', "")


@pytest.fixture
def asked(command, tmp_path):
    """Return a function: text of buffer.toml and arguments → (status, output, errors)."""

    def run(text, *arguments):
        (tmp_path / "buffer.toml").write_text(text)
        return command(*arguments)

    return run


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (UNLISTED.replace('source = "tank"', 'source = "tank"\nmanipulated = true'),
         "buffer.toml, line 14, flows.outflow.manipulated",
         'at the top of the file, before the first table, as in manipulated = ["outflow"]'),
        (UNLISTED, "buffer.toml",
         'or list a flow at the top of the file: manipulated = ["inflow"]'),
    ],
)  # fmt: skip
def test_how_a_flow_becomes_manipulated_is_told(asked, text, place, words):
    status, output, errors = asked(text, "analyse", "buffer.toml")
    assert (status, output) == (2, "")
    assert errors.startswith(f"clepsydra: {place}") and words in errors


def test_a_level_that_nothing_determines_is_told_with_what_does(asked):
    status, output, _ = asked(INTEGRATING, "analyse", "buffer.toml")
    assert status == 0
    assert "give the reading of a sensor under [operating_point]" in " ".join(output.split())
    fixed = f'{INTEGRATING}[operating_point]\nlevel = "1.2 m"\n'
    status, output, _ = asked(fixed, "analyse", "buffer.toml")
    assert "[operating_point]" not in output and "1.20 m" in output


@pytest.mark.parametrize(
    ("arguments", "option", "value"),
    [
        (("simulate", "buffer.toml", "--duration", "5 m"), "--duration", "'5 m'"),
        (("new", "mine", "--study", "--process", "nowhere"), "--process", "'nowhere'"),
        (("export", "buffer.toml", "--to", "st", "--controller", "PI, SMIC"), "--controller",
         "'PI, SMIC'"),
        (("identify", "record.csv", "--process", "nowhere", "--parameters", "a"), "--process",
         "'nowhere'"),
        (("identify", "record.csv", "--process", "buffer.toml", "--parameters", "tnak.area"),
         "--parameters", "'tnak.area'"),
    ],
)  # fmt: skip
def test_a_mistake_in_an_option_is_told_by_its_name(asked, tmp_path, arguments, option, value):
    rows = "\n".join(f"{t},{5 + (t > 20)},{1 - 0.001 * t}" for t in range(60))
    (tmp_path / "record.csv").write_text(f"time [s],outflow [m^3/h],level [m]\n{rows}\n")
    before = sorted(path.name for path in tmp_path.iterdir())
    status, output, errors = asked(INTEGRATING, *arguments)
    assert (status, output) == (2, "")
    assert errors.startswith(f"clepsydra: {option}: got {value}, expected ")
    assert sorted(path.name for path in tmp_path.iterdir()) in (before, ["buffer.toml", *before])


def test_an_unknown_unit_of_a_column_is_told(asked, tmp_path):
    (tmp_path / "record.csv").write_text("time [s],pump [smoot],level [m]\n0,1,2\n1,1,2\n")
    status, output, errors = asked(INTEGRATING, "identify", "record.csv")
    assert (status, output) == (2, "")
    assert "record.csv, line 1, column 'pump': got 'smoot', expected a unit" in errors
