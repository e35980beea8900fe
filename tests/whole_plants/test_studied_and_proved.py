"""Each plant is studied; its simplest good loops, its alarms and itself are proved everywhere."""

from pathlib import Path

import pytest
from tools import need, need_compiler, need_grammar, need_importer

import clepsydra as cl

HERE = Path(__file__).parent
HOTWELL = HERE.parents[1] / "docs" / "examples" / "hotwell.toml"
PLANTS = [
    *sorted(HERE.glob("*.toml")),
    HOTWELL,
    f"{HOTWELL}:open-line",
    f"{HERE / 'pumping-station.toml'}:unlike",
]


@pytest.mark.thorough
@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: str(plant).rpartition("/")[2])
def test_a_plant_is_studied_and_proved_on_every_target(plant):
    need_compiler()
    need_grammar()
    need_importer()
    need("wasmtime")
    study = cl.study(plant)
    simplest = min(study.ranking, key=lambda candidate: candidate.controller.complexity)
    proof = cl.verify([simplest.controller], plant)
    assert proof.holds, proof.failures
