"""The processor that kernels are compiled for."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import llvmlite
import llvmlite.binding as llvm


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
    """

    name: str
    features: str
    lanes: int
    fuses: bool

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
    return Host(llvm.get_host_cpu_name(), features.flatten(), lanes, fuses)
