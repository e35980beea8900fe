#!/usr/bin/env bash
# A 128-bit shift by a variable is a call of compiler-rt on wasm32, which a module without a linker
# does not have. Writing it as seven fixed shifts, each chosen by a bit of the count, has no such
# shift, and compiles without a call where nothing is optimised. LLVM's optimiser, told that every
# shift is fixed, folds the chain back into one shift by a variable: the call of __ashlti3 is there
# at -O1 and not at -O0. The chain to the right with a sticky bit is left alone.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check llvmlite==0.50.0
"$folder/venv/bin/python" - <<'PYTHON'
import re
import sys

import llvmlite
import llvmlite.binding as llvm

llvm.initialize_all_targets()
llvm.initialize_all_asmprinters()
print("llvmlite", llvmlite.__version__, "with LLVM", ".".join(map(str, llvm.llvm_version_info)))
POWERS = (64, 32, 16, 8, 4, 2, 1)


def chain(way: str, sticky: bool) -> str:
    """Return the code of f(x, n) = x shifted by n, 0 to 127, in fixed steps."""
    lines, x = [], "%x"
    for power in POWERS:
        moved = f"%moved{power}"
        lines.append(f"{moved} = {way} i128 {x}, {power}")
        if sticky:
            lines += [
                f"%lost{power} = and i128 {x}, {(1 << power) - 1}",
                f"%some{power} = icmp ne i128 %lost{power}, 0",
                f"%bit{power} = zext i1 %some{power} to i128",
                f"%kept{power} = or i128 {moved}, %bit{power}",
            ]
            moved = f"%kept{power}"
        lines += [
            f"%part{power} = and i64 %n, {power}",
            f"%asked{power} = icmp ne i64 %part{power}, 0",
            f"%x{power} = select i1 %asked{power}, i128 {moved}, i128 {x}",
        ]
        x = f"%x{power}"
    body = "\n  ".join([*lines, f"ret i128 {x}"])
    return f"define i128 @f(i128 %x, i64 %n) {{\n  {body}\n}}\n"


def calls(code: str, level: int) -> list[str]:
    """Return what the object calls that it does not define."""
    machine = llvm.Target.from_triple("wasm32-unknown-unknown").create_target_machine(opt=2)
    with llvm.parse_assembly(code) as module:
        module.triple, module.data_layout = machine.triple, str(machine.target_data)
        options = llvm.create_pipeline_tuning_options(speed_level=level)
        builder = llvm.create_pass_builder(machine, options)
        if level:
            builder.getModulePassManager().run(module, builder)
        names = re.findall(rb"__[a-z]+ti[0-9]", machine.emit_object(module))
    return sorted({name.decode() for name in names})


changed = False
for words, way, sticky, seen in (
    ("left", "shl", False, ["__ashlti3"]),
    ("right with a sticky bit", "lshr", True, []),
):
    plain, optimised = (calls(chain(way, sticky), level) for level in (0, 1))
    print(f"{words}: calls without the optimiser {plain}, with it expected {plain}, "
          f"seen {optimised}")
    changed |= plain != [] or optimised != seen
sys.exit(1 if changed else 0)
PYTHON
