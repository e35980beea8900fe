"""Prints the kernels of OpenBLAS that this machine can run beside its own, each only once.

OPENBLAS_CORETYPE takes more names than there are kernels: Zen runs those of Haswell.
"""

import os
import subprocess
import sys
from pathlib import Path

NAMED = ("Haswell", "SkylakeX", "Zen", "Nehalem")
#: What NumPy and SciPy, which bring a library each, say that they run.
ASK = """
import ctypes, pathlib, numpy, scipy.linalg
for line in pathlib.Path("/proc/self/maps").read_text().splitlines():
    if "openblas" in line and line.endswith(".so"):
        library = ctypes.CDLL(line.split()[-1])
        for ending in ("", "64_"):
            name = getattr(library, f"scipy_openblas_get_corename{ending}", None)
            if name:
                name.restype = ctypes.c_char_p
                print(name().decode())
"""


def runs(name: str) -> set[str]:
    """Return the kernels that the libraries take when one is asked for; none asks for none."""
    environment = os.environ | ({"OPENBLAS_CORETYPE": name} if name else {})
    done = subprocess.run([sys.executable, "-c", ASK], env=environment, capture_output=True)
    return set(done.stdout.decode().split())


if __name__ == "__main__":
    wide = " avx512f " in Path("/proc/cpuinfo").read_text(encoding="utf-8")
    own, found = runs(""), {}
    for name in NAMED:
        kernels = runs(name) if wide or name != "SkylakeX" else own
        if kernels not in (own, *found.values()):
            found[name] = kernels
    if not found:
        sys.exit(f"no other kernel than {own or 'none'} is taken: is NumPy's library OpenBLAS?")
    print(*found)
