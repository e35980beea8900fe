"""Tests that need a compiler or an optional package are skipped without it, and run again by name.

`pytest --last-skipped` runs just what the run before skipped: the checks use it when they have
installed the optional packages, so that no test runs twice.

Where several workers collect all tests, every other one begins at the end: each file is then
rewritten and compiled by one of them, and read by the others.
"""

import gc
import os
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from tools import REQUIRE, missing

_SKIPPED = "clepsydra/skipped"
_FOLDERS = tuple(
    Path("src/clepsydra") / name
    for name in ("deploy/proof", "deploy/fmi", "deploy/compiler.py", "engine/hosted_module.py")
)
#: Folders whose files import a package as they are read, or use it in most that they do.
_NEEDS = {
    "src/clepsydra/rig/doors/modbus": ("pymodbus",),
    "tests/rig/modbus": ("pymodbus",),
    "src/clepsydra/rig/doors/opc_ua": ("asyncua", "cryptography"),
    "tests/rig/opc_ua": ("asyncua", "cryptography"),
    "src/clepsydra/rig/doors/page": ("websockets",),
    "tests/rig/page": ("websockets",),
}
_skipped: set[str] = set()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--last-skipped", action="store_true", help="run only what the run before skipped"
    )


class FromTheEnd(pytest.Dir):
    """A folder of which the last file is collected first."""

    def collect(self) -> Iterator[pytest.Item | pytest.Collector]:
        """Yield its files and folders."""
        return reversed(list(super().collect()))


def _from_the_end(config: pytest.Config) -> bool:
    worker = os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")
    return int(worker) % 2 == 1 and config.args_source is pytest.Config.ArgsSource.TESTPATHS


def pytest_collect_directory(path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if _from_the_end(parent.config) and not (path / "__init__.py").exists():
        return FromTheEnd.from_parent(parent, path=path)
    return None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Look for no garbage while modules and tests are read, which stay, nor among them later."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.collect()
        gc.freeze()


@pytest.hookimpl(tryfirst=True)  # before anything else puts them into an order
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if _from_the_end(config):
        folders = [config.rootpath / folder for folder in config.args]
        items.sort(key=lambda item: ([not item.path.is_relative_to(f) for f in folders], item.path))
    reason = (
        "" if REQUIRE else missing("fmpy", "tree_sitter_iec61131_3_st", "wasmtime", compiler=True)
    )
    if reason:
        for item in items:
            path = item.path.relative_to(config.rootpath)
            if isinstance(item, pytest.DoctestItem) and any(map(path.is_relative_to, _FOLDERS)):
                item.add_marker(pytest.mark.skip(reason=reason))
    if config.getoption("last_skipped"):
        names = set(config.cache.get(_SKIPPED, []))
        # A file that could not be imported was skipped as a whole, by its own name.
        keep = {item for item in items if {item.nodeid, item.nodeid.split("::")[0]} & names}
        config.hook.pytest_deselected(items=[item for item in items if item not in keep])
        items[:] = [item for item in items if item in keep]


@pytest.hookimpl(tryfirst=True)
def pytest_make_collect_report(collector: pytest.Collector) -> pytest.CollectReport | None:
    if REQUIRE or not collector.path.is_file():
        return None
    path = collector.path.relative_to(collector.config.rootpath)
    needed = next((each for folder, each in _NEEDS.items() if path.is_relative_to(folder)), ())
    reason = missing(*needed)
    if not reason:
        return None
    return pytest.CollectReport(collector.nodeid, "skipped", (str(path), 1, reason), [])


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.skipped:
        _skipped.add(report.nodeid)


def pytest_collectreport(report: pytest.CollectReport) -> None:
    if report.skipped:
        _skipped.add(report.nodeid)


def pytest_sessionfinish(session: pytest.Session) -> None:
    config = session.config
    worker, cached = hasattr(config, "workerinput"), hasattr(config, "cache")
    if cached and not worker and not config.getoption("last_skipped"):
        config.cache.set(_SKIPPED, sorted(_skipped))
