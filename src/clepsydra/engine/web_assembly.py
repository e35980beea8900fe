"""A program as a WebAssembly module: the same kernel for a browser, with the same bits."""

from __future__ import annotations

from functools import cache

import llvmlite.binding as llvm

from clepsydra.engine.compiler import kept_object
from clepsydra.engine.fused_multiply_add import FUSED, INTRINSIC, fused_multiply_add
from clepsydra.engine.host import compiler_text
from clepsydra.engine.kernel_code import kernel_code
from clepsydra.engine.kernel_form import KernelForm
from clepsydra.engine.vector_code import KERNEL, vector_code
from clepsydra.engine.wasm_object import IMPORTED_MEMORY, WasmObject, module
from clepsydra.program.inlined import inlined
from clepsydra.program.program import Program

#: What the module takes from its page, and what it gives beside the kernel: the first address
#: of its memory that it does not use itself.
MEMORY, HEAP = ("env", "memory"), "heap"
_TRIPLE = "wasm32-unknown-unknown"
#: A page of memory [bytes].
_PAGE = 1 << 16
_ALIGNMENT = 64

#: Memory for the values of a large kernel: taken from the machine in the first call, and used
#: again in later ones, which ask for as much.
_OWN_MEMORY = f"""\
@kept = internal global ptr null, align 4
declare i32 @llvm.wasm.memory.grow.i32(i32, i32)
declare void @llvm.trap()
define internal ptr @malloc(i64 %size) #1 {{
  %before = load ptr, ptr @kept
  %is.there = icmp ne ptr %before, null
  br i1 %is.there, label %again, label %first
again:
  ret ptr %before
first:
  %up = add i64 %size, {_PAGE - 1}
  %pages.wide = lshr i64 %up, 16
  %pages = trunc i64 %pages.wide to i32
  %old = call i32 @llvm.wasm.memory.grow.i32(i32 0, i32 %pages)
  %refused = icmp slt i32 %old, 0
  br i1 %refused, label %none, label %taken
none:
  ret ptr null
taken:
  %place = shl i32 %old, 16
  %memory = inttoptr i32 %place to ptr
  store ptr %memory, ptr @kept
  ret ptr %memory
}}
define internal void @free(ptr %memory) #1 {{
  ret void
}}
define internal void @abort() #1 {{
  call void @llvm.trap()
  unreachable
}}
"""


def web_assembly(program: Program, *, record: bool = True) -> bytes:
    """Return the kernel of a program as a WebAssembly module, in one lane and nothing fused.

    It imports its memory, `env.memory`, and nothing else, and exports `clepsydra_kernel`, with
    the arguments of `clepsydra.engine.vector_code.vector_code`, and `heap`, the first address that
    is free for them. What it computes is in every bit what `Kernel(program, fuse=False)` does, but
    for the bits of what is not a number.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> from clepsydra.base.signal import Signal
    >>> total = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> program = Program("add_up", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), total)
    >>> web_assembly(program)[:4]
    b'\\x00asm'
    """
    form = KernelForm(1, fuse=False, record=record)
    target = f"{_TRIPLE} {compiler_text()}"
    code = kernel_code(inlined(program), form, _whole_code)
    return _module(kept_object(code, target, _target_machine)[0], program)


def _whole_code(program: Program, form: KernelForm) -> str:
    """Return the code with all that it would import but its memory."""
    code = vector_code(program, form)
    if INTRINSIC in code:
        lines = code.replace(f"{INTRINSIC}(", f"{FUSED}(").splitlines()
        lines = [each for each in lines if not each.startswith(f"declare double {FUSED}(")]
        # Each function once: in its place at every call it takes twice the module and no less time.
        lines = [each.replace(") alwaysinline", ") noinline") for each in lines]
        code = "\n".join([fused_multiply_add(), *lines, ""])
    if "@malloc(" in code:
        own = ("declare ptr @malloc(", "declare void @free(", "declare void @abort(")
        lines = [each for each in code.splitlines() if not each.startswith(own)]
        code = "\n".join([_OWN_MEMORY, *lines, ""])
    return code


@cache
def _target_machine(optimisation: int) -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    return llvm.Target.from_triple(_TRIPLE).create_target_machine(
        opt=optimisation, reloc="static", codemodel="default"
    )


def _module(image: bytes, program: Program) -> bytes:
    """Return the module of an object, whose addresses are final since nothing is beside it.

    What a linker would add is that its kernel is exported.
    """
    whole = WasmObject(image)
    taken = [name for kind, name in whole.imports if kind != IMPORTED_MEMORY]
    if taken:  # LLVM makes calls of operations that the target lacks; no kernel has a stack
        raise RuntimeError(f"the module of {program.name} would import {', '.join(taken)}")
    heap = -(-whole.end_of_data // _ALIGNMENT) * _ALIGNMENT
    return module(whole, KERNEL, memory=MEMORY, pages=heap // _PAGE + 1, constant=(HEAP, heap))
