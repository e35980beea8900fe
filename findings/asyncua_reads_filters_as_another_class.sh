#!/usr/bin/env bash
# asyncua has two classes DataChangeFilter: `ua.DataChangeFilter` is a subclass, made so that
# deadbands can be written as numbers, of the one of the generated protocol, and what is read from a
# message is of the latter. So `isinstance(filter, ua.DataChangeFilter)` is true of what a program
# makes and false of what the same program is sent; a server that looks at the filters of its
# clients in this way takes each for a wrong one.
# Expected: what was written as a class is read as that class.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check asyncua==2.1.0
"$folder/venv/bin/python" - <<'PYTHON'
import sys
from importlib.metadata import version

from asyncua import ua
from asyncua.common.utils import Buffer
from asyncua.ua.ua_binary import struct_from_binary, struct_to_binary

print("asyncua", version("asyncua"))
written = ua.DataChangeFilter(ua.DataChangeTrigger.StatusValue, ua.DeadbandType.Absolute, 5.0)
request = ua.MonitoringParameters(ClientHandle=1, Filter=written, QueueSize=1)
read = struct_from_binary(ua.MonitoringParameters, Buffer(struct_to_binary(request))).Filter
same = (read.Trigger, read.DeadbandType, read.DeadbandValue) == (
    written.Trigger, written.DeadbandType, written.DeadbandValue
)
found = isinstance(written, ua.DataChangeFilter), isinstance(read, ua.DataChangeFilter)
print(f"fields are the same: expected True, seen {same}")
print(f"instances of ua.DataChangeFilter, written and read: expected (True, True), seen {found}")
print(f"class of what is read: {type(read).__module__}.{type(read).__qualname__}")
sys.exit(0 if same and found == (True, False) else 1)
PYTHON
