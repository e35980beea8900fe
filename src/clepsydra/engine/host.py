"""The processor that kernels are compiled for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import llvmlite
import llvmlite.binding as llvm

#: A processor that begins instructions as they are written. Our order is made for such a one; for
#: one that looks ahead LLVM trusts it to find another, within a window too small for a sample.
_IN_ORDER = "atom"


@dataclass(frozen=True)
class Host:
    """The processor's name, its features, and what they mean for a kernel.

    Parameters
    ----------
    name : str
        LLVM's name of the processor.
    features : str
        LLVM's feature list.
    lanes : int
        Doubles in one vector.
    fuses : bool
        Whether multiply-adds are fused in hardware.
    refines : bool
        Whether it approximates reciprocal roots in double precision, eight at a time (AVX-512).
    tune : str
        LLVM's name of the processor by whose model instructions are ordered; its own if empty.
    """

    name: str
    features: str
    lanes: int
    fuses: bool
    refines: bool
    tune: str

    @property
    def fingerprint(self) -> str:
        """Text that differs wherever a compiled object might not run."""
        return f"{llvm.get_default_triple()} {self.name} {self.features} {compiler_text()}"


def compiler_text() -> str:
    """Return what compiles, with its version."""
    version = ".".join(map(str, llvm.llvm_version_info))
    return f"llvmlite {llvmlite.__version__} LLVM {version}"


@cache
def host() -> Host:
    """Return this machine's processor."""
    features = llvm.get_host_cpu_features()
    if features.get("avx512f"):
        lanes = 8
    elif features.get("avx"):
        lanes = 4
    else:
        lanes = 2
    fuses = bool(features.get("fma") or features.get("neon") or features.get("fullfp16"))
    refines = bool(features.get("avx512f"))
    tune = _IN_ORDER if llvm.get_default_triple().startswith("x86_64") else ""
    return Host(llvm.get_host_cpu_name(), features.flatten(), lanes, fuses, refines, tune)
