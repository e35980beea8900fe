"""What of a process file the plant does not use: said, and without effect."""

from pathlib import Path

import pytest
from refusals import refused

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

VALID = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
SALT = '[components.salt]\nrange = ["0 g/l", "40 g/l"]\n'
LAKE = "[reservoirs.lake]\n"


@pytest.fixture
def loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Return a function: what stands below the plant → its process."""
    monkeypatch.chdir(tmp_path)

    def load(more: str) -> Process:
        Path("plant.toml").write_text(f"{VALID}\n{more}", encoding="utf-8")
        return load_process("plant.toml")

    return load


def test_a_reservoir_whose_name_is_mistyped_where_a_flow_enters_is_suggested(loaded):
    flow = '[flows.f]\nsource = "lke"\nrange = ["0 l/s", "1 l/s"]\nnominal = "0 l/s"\n'
    with refused(place="flows.f.source", remedy="perhaps 'lake' was meant"):
        loaded(LAKE + flow + 'destination = "tank_1"\n')


LINE = VALID.count("\n") + 2


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (LAKE, [f"reservoirs.lake (line {LINE}) of plant.toml has no effect: no flow enters"]),
        (
            SALT,
            [f"components.salt (line {LINE}) of plant.toml has no effect: no flow or reservoir"],
        ),
        (
            f'{LAKE}concentration = {{ salt = "5 g/l" }}\n{SALT}',
            [
                f"reservoirs.lake (line {LINE}) of plant.toml has no effect",
                f"components.salt (line {LINE + 2}) of plant.toml has no effect",
            ],
        ),
    ],
)
def test_it_is_said_and_the_plant_is_the_same_without(loaded, more, said):
    without, process = loaded(""), loaded(more)
    assert without.warnings == ()
    assert len(process.warnings) == len(said)
    for warning, words in zip(process.warnings, said, strict=True):
        assert warning.startswith(words)
    assert [each.name for each in process.elements] == [each.name for each in without.elements]
    for group in ("state", "inputs", "disturbances", "measurements", "parameters", "components"):
        assert getattr(process, group) == getattr(without, group)
    point = find_equilibrium(process)
    assert point.as_dict() == find_equilibrium(without).as_dict()
    assert point.warnings[: len(said)] == process.warnings


def test_what_is_used_stays(loaded):
    process = loaded(
        f'{SALT}[flows.brine]\ndestination = "tank_2"\nnominal = "0.1 cm^3/s"\n'
        'range = ["0 cm^3/s", "1 cm^3/s"]\nconcentration = { salt = "5 g/l" }\n'
    )
    assert process.warnings == ()
    assert [component.name for component in process.components] == ["salt"]


def test_a_sensor_of_what_enters_nowhere_is_refused(loaded):
    sensor = '[sensors.salinity]\ntank = "tank_1"\ncomponent = "salt"\nrange = ["0 g/l", "9 g/l"]\n'
    with refused(place="components.salt", expected="some flow or reservoir brings"):
        loaded(SALT + sensor)


def test_a_variant_that_uses_it_has_no_warning(loaded):
    """The reservoir that only a variant draws from is said where that is not in force."""
    variant = '[variants.lake]\npumps.pump_1.source = "lake"\n'
    assert len(loaded(LAKE + variant).warnings) == 1
    drawn = load_process("plant.toml:lake")
    assert drawn.warnings == () and "lake" in [element.name for element in drawn.elements]
