"""An export is the same whatever kernel and threads the linear algebra of the machine has."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from digests_of_designs import digests

from clepsydra.process.catalogue_names import catalogue_names

#: What OpenBLAS can be told, and the instructions that a processor needs for it. For Zen it takes
#: the kernels of Haswell.
KERNELS = {"Nehalem": "sse4_2", "Zen": "avx2", "SkylakeX": "avx512f"}
CPU = Path("/proc/cpuinfo")


def digests_under(kernel, threads, process):
    """Return the digests as another process finds them."""
    if not CPU.exists() or KERNELS[kernel] not in CPU.read_text(encoding="utf-8").split():
        pytest.skip(f"this processor has no {KERNELS[kernel]} for the kernel {kernel}")
    script = Path(__file__).with_name("digests_of_designs.py")
    environment = os.environ | {"OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": str(threads)}
    found = subprocess.run(
        [sys.executable, script, process],
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    return json.loads(found.stdout)


@pytest.mark.thorough
@pytest.mark.parametrize("process", catalogue_names())
def test_every_design(process):
    expected = digests(process)
    for kernel, threads in (("Zen", 2), ("SkylakeX", 2), ("Nehalem", 1)):
        assert digests_under(kernel, threads, process) == expected, f"{kernel}, {threads} threads"
