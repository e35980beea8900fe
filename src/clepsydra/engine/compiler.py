"""LLVM code to a callable function."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import llvmlite.binding as llvm

from clepsydra.engine.host import host
from clepsydra.engine.object_cache import ObjectCache, default_cache
from clepsydra.engine.unprinted import Unprinted

#: LLVM has one context, whatever is compiled.
_lock = threading.RLock()


@dataclass(frozen=True)
class Effort:
    """How machine code is made; part of the key under which it is kept.

    Parameters
    ----------
    optimisation : int
        LLVM's level for choosing instructions and registers.
    pipeline : int
        Its level for what comes before.
    """

    optimisation: int
    pipeline: int


#: What loops gain by, and what a long row of operations does not: that one takes half of the time
#: to compile with little effort, and as long to run.
FULL, LITTLE = Effort(2, 1), Effort(1, 0)


@cache
def _target_machine(optimisation: int) -> llvm.TargetMachine:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    processor = host()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=processor.name,
        features=processor.features,
        opt=optimisation,
        reloc="pic",
        codemodel="small",
        jit=True,
    )


@cache
def _linker() -> llvm.LLJIT:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.create_lljit_compiler(use_jit_link=False)


class CompiledFunction:
    """A native function and the code memory that it lives in.

    Parameters
    ----------
    code : Unprinted
        LLVM code that defines the function.
    symbol : str
        Its name.
    signature : ctypes function type
    cache : ObjectCache, optional
        Where objects are kept; the user's cache folder if omitted.
    effort : Effort, optional
    """

    def __init__(
        self,
        code: Unprinted,
        symbol: str,
        signature: Any,
        cache: ObjectCache | None = None,
        effort: Effort = FULL,
    ) -> None:
        with _lock:
            image, self.was_cached = kept_object(
                code, host().fingerprint, cache=cache, effort=effort
            )
            library = llvm.JITLibraryBuilder()
            library.add_object_img(image).add_current_process().export_symbol(symbol)
            self._tracker = library.link(_linker(), f"{symbol}_{id(self):x}_{next(_serial)}")
        self.address: int = self._tracker[symbol]
        self.call: Callable[..., None] = signature(self.address)


def _numbers() -> Any:
    number = 0
    while True:
        yield number
        number += 1


_serial = _numbers()


def kept_object(
    code: Unprinted,
    target: str,
    machine: Callable[[int], llvm.TargetMachine] = _target_machine,
    cache: ObjectCache | None = None,
    effort: Effort = FULL,
) -> tuple[bytes, bool]:
    """Return the object of LLVM code, and whether it was kept from before; else it is printed.

    Parameters
    ----------
    code : Unprinted
    target : str
        What it is for, and what compiles it, with its version.
    machine : callable
        Returns the machine that it is for, by the level of optimisation; this processor if left
        out.
    cache : ObjectCache, optional
        Where objects are kept; the user's cache folder if omitted.
    effort : Effort, optional
    """
    store, key = cache or default_cache(), "\n".join([target, str(effort), code.content])
    with _lock:
        image = store.load(key)
        if image is not None:
            return image, True
        image = _compiled(code.code(), machine(effort.optimisation), effort.pipeline)
        store.store(key, image)
        return image, False


def _compiled(code: str, machine: llvm.TargetMachine, pipeline: int) -> bytes:
    """Return the object of LLVM code, optimised without changing any rounding."""
    with llvm.parse_assembly(code) as module:
        module.verify()
        module.triple = machine.triple
        module.data_layout = str(machine.target_data)
        options = llvm.create_pipeline_tuning_options(speed_level=pipeline)
        builder = llvm.create_pass_builder(machine, options)
        builder.getModulePassManager().run(module, builder)
        return machine.emit_object(module)


def signature_of(pointers: int, counts: int) -> Any:
    """Return the ctypes form of a function of pointers and then of whole numbers."""
    return ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * pointers, *[ctypes.c_int64] * counts)
