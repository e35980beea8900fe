"""A path that the system does not let anybody look at is refused in words by every call."""

import pytest
from refusals import refused

import clepsydra as cl

PATHS = {"x" * 300: "file name too long", "forbidden/own": "permission denied"}
CALLS = {
    "load": lambda path: cl.load(f"{path}.toml"),
    "load a name": cl.load,
    "identify": lambda path: cl.identify(f"{path}.csv"),
    "load_law": lambda path: cl.load_law(f"{path}.py"),
    "draw": lambda path: cl.draw("three-tanks", f"{path}.svg"),
    "analyse": lambda path: cl.analyse("three-tanks").report(f"{path}.html"),
    "save": lambda path: cl.simulate("three-tanks", None, duration="1 min").save(f"{path}.csv"),
    "export": lambda path: cl.export(None, "three-tanks", path, to="fmu"),
    "study": lambda path: cl.study("three-tanks", folder=path),
    "new_process": lambda path: cl.new_process("mine", folder=path),
    "new_lesson": lambda path: cl.new_lesson("mine", folder=path),
    "new_study": lambda path: cl.new_study("mine", "three-tanks", folder=path),
    "tune": lambda path: cl.tune(
        cl.design.simc("three-tanks"), "three-tanks", duration="1 min", state_file=path
    ),
    "verify": lambda path: cl.verify(cl.design.simc("three-tanks"), "three-tanks", folder=path),
}


@pytest.mark.parametrize("path", PATHS, ids=PATHS.values())
@pytest.mark.parametrize("call", CALLS)
def test_a_call_refuses_it(tmp_path, monkeypatch, forbidden, call, path):
    forbidden(tmp_path / "forbidden")
    monkeypatch.chdir(tmp_path)
    with refused() as refusal:
        CALLS[call](path)
    said = f"{refusal.value.value} {refusal.value.remedy}"
    assert PATHS[path] in said
