"""Regulators in MAT files, as a page reads them: the numbers that Python reads, or a refusal."""

import random
import shutil
import subprocess
from io import BytesIO

import numpy as np
import pytest
from page_in_node import answered, source
from scipy import sparse
from scipy.io import savemat

from clepsydra.designs.regulators.mat_file import read_mat

READ = f"""
import {{ readFileSync }} from "node:fs";
import {{ regulatorOf }} from "{source("lab/regulator_file.ts")}";
import {{ Refused }} from "{source("lab/refused.ts")}";
const rows = (of) => Array.from({{ length: of.rows }}, (_, row) =>
  [...of.values.subarray(row * of.columns, (row + 1) * of.columns)]);
const found = [];
for (const path of given)
  try {{
    const {{ A, B, C, D, period }} = await regulatorOf(path, new Uint8Array(readFileSync(path)));
    found.push({{ A: rows(A), B: rows(B), C: rows(C), D: rows(D), period }});
  }} catch (error) {{
    if (!(error instanceof Refused)) throw error;
    found.push({{ place: error.place, given: error.given, remedy: error.remedy }});
  }}
answer(found);
"""
A = np.array([[0, 0, 0], [0, -3, 0], [0, 2, -20]])
B = np.array([[1, 0], [0, 7], [5, 0]])
C = np.array([[1, 0, 3], [0, 1, 0]])
D = np.array([[3, 0], [1, 2]])
WHOLE = {"A": A, "B": B, "C": C, "D": D}


def of_order(states, kind="float64"):
    """Return matrices of so many states, of numbers of a kind."""
    draw = np.random.default_rng(states).integers(-9, 9, (states + 2, states + 2))
    n = states
    found = {"A": draw[:n, :n], "B": draw[:n, n:], "C": draw[n:, :n], "D": draw[n:, n:]}
    return {name: each.astype(kind) for name, each in found.items()}


@pytest.mark.parametrize("kind", ["int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
                                  "uint64", "float32", "float64"])  # fmt: skip
def test_numbers_of_every_kind_are_those_that_python_reads(kind, tmp_path):
    """In versions 4, 6 and 7, from 1 to 12 states, with a whole order and a broken one."""
    paths = []
    for states in (1, 3, 12):
        matrices = {name: abs(each) for name, each in of_order(states, "int64").items()}
        matrices = {name: each.astype(kind) for name, each in matrices.items()}
        for form, packed in (("4", False), ("5", False), ("5", True)):
            if form == "4" and kind in ("int8", "uint32", "int64", "uint64"):
                continue  # SciPy writes those as doubles there, or not at all
            path = tmp_path / f"reg-{states}-{form}-{packed}.mat"
            savemat(path, matrices, format=form, do_compression=packed)
            paths.append(path)
    for path, found in zip(paths, answered(READ, [*map(str, paths)], tmp_path), strict=True):
        wanted = read_mat(path)
        for name in "ABCD":
            assert found[name] == getattr(wanted, name).tolist()
        assert found["period"] is None


@pytest.mark.skipif(not shutil.which("octave-cli"), reason="needs Octave")
def test_what_octave_writes_is_read(tmp_path):
    script = tmp_path / "written.m"
    lines = [f"{name} = {each.tolist()};".replace("], [", "; ") for name, each in WHOLE.items()]
    kept = "'A', 'B', 'C', 'D', 'E'"
    saves = [f"save('reg{version}.mat', {kept}, '-v{version}');" for version in (4, 6, 7)]
    script.write_text("\n".join([*lines, "E = [];", *saves, f"save('text.mat', {kept});"]))
    subprocess.run(["octave-cli", "--no-init-file", script], cwd=tmp_path, check=True)
    paths = [str(tmp_path / f"{name}.mat") for name in ("reg4", "reg6", "reg7", "text")]
    *read, refused = answered(READ, paths, tmp_path)
    for found in read:
        assert found == {name: each.tolist() for name, each in WHOLE.items()} | {"period": None}
    assert refused["given"] == "Octave's text form" and "-v7" in refused["remedy"]


@pytest.mark.parametrize(
    ("changed", "part", "value", "remedy"),
    [
        ({"D": None, "K": 1.0}, "", "A, B, C, K", "-v7"),
        ({"A": {"a": 1.0}}, ", A", "struct 1 × 1", "ssdata"),
        ({"A": sparse.csc_matrix(A.astype(float))}, ", A", "sparse 3 × 3", "full(A)"),
        ({"A": np.zeros((61, 61))}, ", A", "double 61 × 61", "low order"),
        ({"A": np.zeros((13, 13))}, ", A", "13 × 13", "in a study file"),
        ({"A": np.zeros((2, 3))}, ", A", "2 × 3", "one state space"),
        ({"A": np.zeros((0, 0))}, ", A", "0 × 0", "PI or PID"),
        ({"B": B[:2]}, ", B", "2 × 2", "one state space"),
        ({"C": C[:, :2]}, ", C", "2 × 2", "one state space"),
        ({"D": 2.0}, ", D", "1 × 1", "one state space"),
        ({"B": 1j * B}, ", B", "complex numbers", "real(B)"),
        ({"A": np.full((3, 3), np.inf)}, ", A", "∞", "how the regulator was made"),
        ({"E": np.diag([1.0, 1.0, 0.0])}, ", E", "another matrix", "explicit"),
        ({"E": np.eye(2)}, ", E", "another matrix", "explicit"),
        ({"Ts": -1.0}, ", Ts", "-1", "0 in continuous time"),
        ({"Ts": [1.0, 1.0]}, ", Ts", "1, 1", "0 in continuous time"),
    ],
)  # fmt: skip
def test_what_is_no_regulator_is_refused_in_its_place(changed, part, value, remedy, tmp_path):
    path = tmp_path / "reg1.mat"
    savemat(path, {name: each for name, each in (WHOLE | changed).items() if each is not None})
    (found,) = answered(READ, [str(path)], tmp_path)
    assert found["place"] == f"{path}{part}"
    assert found["given"] == value and remedy in found["remedy"]


def test_an_identity_or_an_empty_descriptor_matrix_and_a_period_are_read(tmp_path):
    paths = [tmp_path / f"reg{number}.mat" for number in range(3)]
    for path, more in zip(
        paths, ({"E": np.eye(3)}, {"E": np.zeros((0, 0))}, {"Ts": 0.5}), strict=True
    ):
        savemat(path, WHOLE | {"D": 0} | more)
    found = answered(READ, [*map(str, paths)], tmp_path)
    assert [each["period"] for each in found] == [None, None, 0.5]
    assert all(each["D"] == [[0, 0], [0, 0]] for each in found)


@pytest.mark.parametrize(
    ("content", "given"),
    [
        (b"", "something that is not a MAT file, or is damaged"),
        (b"x' = A x", "something that is not a MAT file, or is damaged"),
        (b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n", "version 7.3, an HDF5 file"),
        (b"Octave-1-L\0" + bytes(20), "Octave's binary form"),
        (bytes(1_000_001), "more than 1 MB"),
    ],
)
def test_another_file_is_refused_with_what_to_do(content, given, tmp_path):
    path = tmp_path / "reg1.mat"
    path.write_bytes(content)
    (found,) = answered(READ, [str(path)], tmp_path)
    assert found["given"] == given
    assert "-v7" in found["remedy"] or given.startswith("more")


@pytest.mark.parametrize(("version", "packed"), [("4", False), ("5", False), ("5", True)])
def test_a_damaged_file_is_refused_or_read_as_python_reads_it(version, packed, tmp_path):
    draw, file = random.Random(version), BytesIO()
    savemat(file, WHOLE | {"Ts": 1.0}, format=version, do_compression=packed)
    whole, paths = file.getvalue(), []
    for number in range(150):
        content = bytearray(whole)
        for _ in range(draw.choice((1, 2, 5))):
            content[draw.randrange(len(content))] = draw.randrange(256)
        paths.append(tmp_path / f"{number}.mat")
        paths[-1].write_bytes(content[: draw.choice((len(content), draw.randrange(len(content))))])
    read = 0
    for path, found in zip(paths, answered(READ, [*map(str, paths)], tmp_path), strict=True):
        if "place" in found:
            assert found["place"].startswith(str(path)) and found["remedy"]
            continue
        read += 1
        wanted = read_mat(path)
        assert all(found[name] == getattr(wanted, name).tolist() for name in "ABCD")
    assert 0 < read < 100
