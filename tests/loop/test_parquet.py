"""Trajectories on disk: units in the schema, bits kept, whole or nothing."""

import os
from dataclasses import replace

import numpy as np
import pandas
import pyarrow.parquet
import pytest
from refusals import refused

from clepsydra import InputError
from clepsydra.designs.simc import design_simc
from clepsydra.linear.analysis import analyse
from clepsydra.loop.run import Run
from clepsydra.loop.scenario import Scenario
from clepsydra.loop.trajectory_file import fitting, write_parquet
from clepsydra.process.reader import load_process


@pytest.fixture(scope="module")
def runs() -> list[Run]:
    """Two runs of other length with random numbers, some of them special."""
    process = load_process("quadruple-tank")
    analysis = analyse(process)
    controller = design_simc(analysis.model, analysis.pairing)
    random = np.random.default_rng(1)
    made = []
    for name, samples in (("first", 7), ("second, with a comma", 5)):
        nothing = np.zeros((samples, 2))
        signals = (*process.state, *process.inputs, *process.disturbances)
        values = {signal.name: random.normal(size=samples) for signal in signals}
        values["tank_1.level"][:3] = [np.nan, np.inf, -0.0]
        scenario = Scenario(1.0, nothing, nothing, np.zeros((samples, 4)), (), 1)
        made.append(
            Run(
                process=process,
                controller=replace(controller, name=name),
                scenario=scenario,
                time=0.5 * np.arange(samples),
                signals=signals,
                values=values,
                error_estimate=None,
                substeps=1,
                final_state=None,
            )
        )
    return made


def same_bits(a, b) -> bool:
    return np.asarray(a).tobytes() == np.asarray(b).tobytes()


def test_pandas_reads_what_was_written_bit_for_bit(runs, tmp_path):
    path = tmp_path / "runs.parquet"
    write_parquet(runs, path)
    table = pandas.read_parquet(path)
    assert set(table.columns) == {"controller", "time", *runs[0].values}
    assert len(table) == 12
    assert table["controller"].tolist() == ["first"] * 7 + ["second, with a comma"] * 5
    for run in runs:
        rows = table[table["controller"] == run.controller.name]
        assert same_bits(rows["time"], run.time)
        for name, values in run.values.items():
            assert same_bits(rows[name], values), name


def test_the_schema_carries_a_unit_for_every_number(runs, tmp_path):
    path = tmp_path / "runs.parquet"
    write_parquet(runs, path)
    schema = pyarrow.parquet.read_schema(path)
    units = {
        name: schema.field(name).metadata[b"unit"].decode()
        for name in schema.names
        if name != "controller"
    }
    assert units == {
        "time": "s",
        **{f"tank_{i}.level": "m" for i in (1, 2, 3, 4)},
        **{f"pump_{i}": "V" for i in (1, 2)},
        **{f"inflow_{i}": "m^3/s" for i in (1, 2)},
    }
    assert b"quadruple-tank" in schema.metadata.values()


def test_no_run_is_refused(tmp_path):
    with refused(expected="at least one run"):
        write_parquet([], tmp_path / "runs.parquet")


def test_a_missing_folder_is_refused(runs, tmp_path):
    with refused(remedy="folder"):
        write_parquet(runs, tmp_path / "missing" / "runs.parquet")
    assert list(tmp_path.iterdir()) == []


def test_runs_that_do_not_fit_together_leave_no_file(runs, tmp_path):
    other = replace(runs[1], values={"tank_1.level": runs[1].values["tank_1.level"]})
    path = tmp_path / "runs.parquet"
    path.write_text("an older file")
    with pytest.raises(Exception, match=r"tank_2\.level|column|length"):
        write_parquet([runs[0], other], path)
    assert [p.name for p in tmp_path.iterdir()] == ["runs.parquet"]
    assert path.read_text() == "an older file"


@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
@pytest.mark.parametrize("there_before", [True, False])
def test_a_disk_that_fills_up_leaves_the_older_file_or_none(runs, tmp_path, there_before):
    import resource

    path = tmp_path / "runs.parquet"
    if there_before:
        write_parquet(runs[:1], path)
    before = {p.name: p.read_bytes() for p in tmp_path.iterdir()}
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (300, hard))
    try:
        with pytest.raises((OSError, InputError)):
            write_parquet(runs, path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert {p.name: p.read_bytes() for p in tmp_path.iterdir()} == before


def test_as_many_fit_as_the_file_then_holds(runs, tmp_path):
    """What is counted run by run has a head for each, so that the file is never larger."""
    path = tmp_path / "runs.parquet"
    write_parquet(runs, path)
    whole = path.stat().st_size
    assert fitting(runs, 2 * whole) == 2
    assert fitting(runs, whole // 2) == 1
    assert fitting(runs, 1) == 1


def test_a_day_of_noise_takes_less_room_than_its_numbers(runs, tmp_path):
    """The bytes of exponents stand side by side; those of the digits of noise no one packs."""
    noise = np.random.default_rng(1).normal(size=100_000)
    run = replace(runs[0], time=np.arange(100_000.0), values=dict.fromkeys(runs[0].values, noise))
    path = tmp_path / "noise.parquet"
    write_parquet([run], path)
    assert path.stat().st_size < 0.95 * 8 * 100_000 * (1 + len(run.signals))
