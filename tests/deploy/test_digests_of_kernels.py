"""An export is the same whatever kernel and threads the linear algebra of the machine has."""

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest
from digests_of_designs import digests

from clepsydra.process.catalogue_names import catalogue_names

#: What OpenBLAS can be told, and the instructions that a processor needs for it. For Zen it takes
#: the kernels of Haswell.
KERNELS = {"Nehalem": "sse4_2", "Zen": "avx2", "SkylakeX": "avx512f"}
CPU = Path("/proc/cpuinfo")


@pytest.fixture(scope="module")
def elsewhere():
    """Return a function: kernel, threads → a process with these that digests what it is told."""
    started = []

    @cache
    def running(kernel, threads):
        if not CPU.exists() or KERNELS[kernel] not in CPU.read_text(encoding="utf-8").split():
            pytest.skip(f"this processor has no {KERNELS[kernel]} for the kernel {kernel}")
        told = {"OPENBLAS_CORETYPE": kernel, "OPENBLAS_NUM_THREADS": str(threads)}
        told["OPENBLAS_THREAD_TIMEOUT"] = "4"  # a thread without work sleeps at once
        started.append(
            subprocess.Popen(
                [sys.executable, Path(__file__).with_name("digests_of_designs.py")],
                env=os.environ | told,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        return started[-1]

    yield running
    for process in started:
        process.communicate()


@pytest.fixture(scope="module")
def here():
    return cache(digests)


@pytest.mark.thorough
@pytest.mark.parametrize(("kernel", "threads"), [("Zen", 2), ("SkylakeX", 2), ("Nehalem", 1)])
@pytest.mark.parametrize("process", catalogue_names())
def test_every_design(process, kernel, threads, here, elsewhere):
    other = elsewhere(kernel, threads)
    print(process, file=other.stdin, flush=True)
    expected, answer = here(process), other.stdout.readline()
    assert json.loads(answer) == expected
