#!/usr/bin/env bash
# LLVM's x86-64 backend keeps vectors of 64 bytes, for which it has no register left, on a stack that
# it leaves aligned to 16 bytes: three of four lie across two lines of the cache, and each of these
# takes two accesses. One would expect the slots that a compiler lays out itself to be aligned, as GCC
# does it. LLVM aligns the stack where a function has the attributes alignstack(64) and
# "stackrealign"; a batch of control loops in vectors took 5 % less time with them.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check llvmlite==0.50.0
cat >"$folder/spills.py" <<'PYTHON'
import re
import sys

import llvmlite
import llvmlite.binding as llvm

VECTORS, KIND = 48, "<8 x double>"


def assembly(attributes):
    """Return the code of a function in which more vectors live than there are registers."""
    lines = [f"define void @sums(ptr %from, ptr %to) {attributes} {{"]
    for k in range(VECTORS):
        lines += [
            f"  %a{k} = getelementptr double, ptr %from, i64 {8 * k}",
            f"  %x{k} = load volatile {KIND}, ptr %a{k}, align 8",
        ]
    total = "%x0"
    for k in range(1, VECTORS):
        lines.append(f"  %s{k} = fadd {KIND} {total}, %x{VECTORS - k}")
        total = f"%s{k}"
    lines += [f"  store {KIND} {total}, ptr %to, align 8", "  ret void", "}"]
    with llvm.parse_assembly("\n".join(lines)) as module:
        return machine.emit_assembly(module)


def slots(text):
    """Return how many moves to and from the stack may cross a line, and how many may not."""
    places = [line for line in re.findall(r"\tvmov[ua]p[sd]\t[^\n]*", text) if "(%rsp)" in line]
    assert places
    return sum("vmovu" in each for each in places), sum("vmova" in each for each in places)


llvm.initialize_all_targets()
llvm.initialize_all_asmprinters()
target = llvm.Target.from_triple("x86_64-unknown-linux-gnu")
machine = target.create_target_machine(cpu="skylake-avx512", features="+avx512f", opt=2)
left, asked = slots(assembly("")), slots(assembly('alignstack(64) "stackrealign"'))
version = ".".join(map(str, llvm.llvm_version_info))
print(f"llvmlite {llvmlite.__version__}, LLVM {version}")
print("moves of spilled vectors that may cross a line of the cache, and aligned ones")
print(f"expected without asking: 0 unaligned; seen: {left[0]} unaligned, {left[1]} aligned")
print(f"with alignstack(64) and stackrealign: {asked[0]} unaligned, {asked[1]} aligned")
sys.exit(0 if left[0] and not left[1] and asked[1] and not asked[0] else 1)
PYTHON
"$folder/venv/bin/python" "$folder/spills.py"
