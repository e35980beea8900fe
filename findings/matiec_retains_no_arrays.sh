#!/usr/bin/env bash
# A variable that is declared RETAIN has a flag in the C that matiec makes, by which a runtime finds
# what it has to keep over a power failure: __INIT_VAR sets it. An array, or any variable whose
# initial value is a structure, is initialised by __SET_VAR instead, which sets none: declared in
# the same VAR RETAIN, the number is kept and the array beside it begins anew, without a word of the
# compiler. A law with a dead time in it would go on with half of its memory.
#
# Needs git, autoconf, automake, bison, flex and g++. MATIEC names another copy of the repository.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
commit=6bb2c339df6fd096d52f5342be228b0811fef771
git clone --quiet "${MATIEC:-https://github.com/beremiz/matiec}" "$folder/matiec"
git -C "$folder/matiec" checkout --quiet "$commit"
(cd "$folder/matiec" && autoreconf -i && ./configure && make -j2) >"$folder/log" 2>&1 ||
    { tail -20 "$folder/log"; exit 2; }
echo "matiec $(git -C "$folder/matiec" log -1 --format='%h of %cs')"
cat >"$folder/keeps.st" <<'TEXT'
FUNCTION_BLOCK keeps
VAR RETAIN
  number : LREAL := 1.0;
  numbers : ARRAY [0..2] OF LREAL := [1.0, 2.0, 3.0];
END_VAR
VAR_OUTPUT shown : LREAL; END_VAR
number := number + 1.0;
numbers[1] := number;
shown := numbers[1];
END_FUNCTION_BLOCK
TEXT
cat >"$folder/told.c" <<'TEXT'
#include "iec_std_lib.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
#include "accessor.h"
#include "POUS.h"
#include "POUS.c"
#include <stdio.h>
int main(void)
{
    static KEEPS block;
    KEEPS_init__(&block, 0);
    printf("%d %d\n", !!(block.NUMBER.flags & __IEC_RETAIN_FLAG),
           !!(block.NUMBERS.flags & __IEC_RETAIN_FLAG));
    return 0;
}
TEXT
"$folder/matiec/iec2c" -I "$folder/matiec/lib" -T "$folder" "$folder/keeps.st" >/dev/null
cc -w -I "$folder" -I "$folder/matiec/lib/C" -o "$folder/told" "$folder/told.c" -lm
seen=$("$folder/told")
echo "flagged to be kept, number and array: expected 1 1, seen $seen"
[ "$seen" = "1 0" ] || exit 1
