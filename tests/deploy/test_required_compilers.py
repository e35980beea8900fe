"""Without matiec and STruC++ their tests are skipped, and fail where both are required."""

import shutil

import pytest
from matiec import Matiec
from strucpp import Strucpp

SKIPPED, FAILED = pytest.skip.Exception, pytest.fail.Exception


@pytest.mark.parametrize(("required", "outcome"), [("", SKIPPED), ("0", SKIPPED), ("1", FAILED)])
@pytest.mark.parametrize("compiler", [Matiec, Strucpp])
def test_a_missing_compiler(monkeypatch, required, outcome, compiler):
    for name in ("CLEPSYDRA_MATIEC", "CLEPSYDRA_STRUCPP"):
        monkeypatch.setenv(name, "/no/such/compiler")
    monkeypatch.setenv("CLEPSYDRA_REQUIRE_ST_COMPILERS", required)
    monkeypatch.setattr(shutil, "which", lambda program: None)
    with pytest.raises((SKIPPED, FAILED)) as ended:
        compiler()
    assert ended.type is outcome


@pytest.mark.parametrize(("required", "outcome"), [("", SKIPPED), ("1", FAILED)])
def test_a_compiler_without_its_library(monkeypatch, tmp_path, required, outcome):
    program = tmp_path / "bin" / "iec2c"
    program.parent.mkdir()
    program.touch()
    monkeypatch.setenv("CLEPSYDRA_MATIEC", str(program))
    monkeypatch.setenv("CLEPSYDRA_REQUIRE_ST_COMPILERS", required)
    monkeypatch.setattr(shutil, "which", lambda program: "/usr/bin/cc")
    with pytest.raises((SKIPPED, FAILED), match="is not beside it") as ended:
        Matiec()
    assert ended.type is outcome
