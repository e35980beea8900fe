"""How a program becomes a kernel."""

from __future__ import annotations

from dataclasses import dataclass

from clepsydra.engine.host import Host


@dataclass(frozen=True)
class KernelForm:
    """How a program becomes a kernel.

    Parameters
    ----------
    lanes : int
        Scenarios that one pass computes side by side; 1 for a single run.
    individual : frozenset of str
        Inputs that differ from scenario to scenario; all others are shared.
    fuse : bool
        Whether operations marked as fused become fused multiply-adds.
    record : bool
        Whether the outputs are stored.
    processor : Host, optional
        What it is made for, which orders its statements, and prints a sample a second time for
        where usual conditions hold: faster, longer. None of that if left out.
    """

    lanes: int
    individual: frozenset[str] = frozenset()
    fuse: bool = True
    record: bool = True
    processor: Host | None = None
    noisy: frozenset[str] = frozenset()

    @property
    def attributes(self) -> str:
        """Return what LLVM is asked for."""
        found = ["nounwind", '"prefer-vector-width"="512"']
        if self.lanes > 2:
            # A vector on the stack that crosses a line of the cache takes twice as long.
            found += ["alignstack=64", '"stackrealign"']
        if self.processor and self.processor.tune:
            found.append(f'"tune-cpu"="{self.processor.tune}"')
        return " ".join(found)
