"""What the numbers were measured on."""

from __future__ import annotations

import importlib.metadata
import os
import platform
from datetime import date
from pathlib import Path

from benchmarks.cplusplus import compiler_version


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    facts = dict(line.split(":", 1) for line in lines if ":" in line)
    facts = {key.strip(): value.strip() for key, value in facts.items()}
    if "model name" not in facts:
        return platform.machine()
    numbers = f"family {facts.get('cpu family', '?')}, model {facts.get('model', '?')}"
    return f"{facts['model name']} ({numbers})"


def _vector_sets() -> str:
    from clepsydra.engine.host import host

    features = host().features.split(",")
    wanted = ("sse2", "avx2", "fma", "avx512f", "neon", "sve")
    return ", ".join(name for name in wanted if f"+{name}" in features) or "none known"


def _memory() -> str:
    try:
        size = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError, AttributeError):
        return "unknown"
    return f"{size / 2**30:.0f} GiB"


def description() -> list[tuple[str, str]]:
    """Return what a reader must know of this machine, as (heading, content)."""
    packages = ("clepsydra", "casadi", "llvmlite", "numpy", "jax", "control")
    versions = {}
    for package in packages:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "from the source tree"
    load = f"{os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else "unknown"
    return [
        ("Date", date.today().isoformat()),
        ("Processor", f"{_processor()}, {os.cpu_count()} cores"),
        ("Vector sets", _vector_sets()),
        ("Memory", _memory()),
        ("System", f"{platform.system()} {platform.release()}, Python {platform.python_version()}"),
        ("C++ compiler", compiler_version()),
        ("Packages", ", ".join(f"{name} {version}" for name, version in versions.items())),
        ("Load before the start", load),
    ]
