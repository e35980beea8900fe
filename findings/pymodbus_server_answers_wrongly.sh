#!/usr/bin/env bash
# The TCP server of pymodbus against the Modbus Application Protocol V1.1b3. Each request is a valid
# frame on loopback:
# - two requests in one segment, as a master sends that does not wait: only the first is answered
#   (a send empties the buffer of what was received);
# - a read of 126 registers, one more than there may be (section 6.3: exception 3 to function 3, so
#   the bytes 83 03): answered by 80 01, a function that nobody asked for, so that a master waits
#   for its time-out; an unknown function 99 (E3 01) likewise;
# - a coil set to 0001, where 0000 and FF00 are all that there is (section 6.5: exception 3, and the
#   coil stays): set to on;
# - a read-and-write whose read address is not there (section 6.17 checks it before it writes):
#   exception 2, but written.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pymodbus==3.16.1
cat >"$folder/server.py" <<'PYTHON'
import asyncio
import logging
import sys

import pymodbus
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

logging.getLogger("pymodbus").addHandler(logging.NullHandler())
BITS = [SimData(0, values=[False] * 16, datatype=DataType.BITS)]
WORDS = [SimData(0, count=10, values=5, datatype=DataType.REGISTERS)]


async def ask(port, request):
    """Return all that is answered within half a second."""
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(bytes.fromhex(request))
    found = b""
    try:
        while True:
            found += await asyncio.wait_for(reader.read(1000), 0.5)
    except asyncio.TimeoutError:
        pass
    writer.close()
    return found.hex(" ")


async def main():
    device = SimDevice(id=1, simdata=(BITS, list(BITS), WORDS, list(WORDS)))
    server = ModbusTcpServer(device, address=("127.0.0.1", 0))
    await server.serve_forever(background=True)
    port = server.transport.sockets[0].getsockname()[1]
    print("pymodbus", pymodbus.__version__)
    read = "00 01 00 00 00 06 01 03 00 00 00 01"
    cases = {
        "two requests in a segment": (
            read + read.replace("00 01", "00 02", 1),
            "00 01 00 00 00 05 01 03 02 00 05 00 02 00 00 00 05 01 03 02 00 05",
        ),
        "126 registers": ("00 01 00 00 00 06 01 03 00 00 00 7e", "00 01 00 00 00 03 01 83 03"),
        "function 99": ("00 01 00 00 00 06 01 63 00 00 00 01", "00 01 00 00 00 03 01 e3 01"),
        "coil 0 := 0001": ("00 01 00 00 00 06 01 05 00 00 00 01", "00 01 00 00 00 03 01 85 03"),
        "write 9 to register 0 and read 100": (
            "00 01 00 00 00 0d 01 17 00 64 00 01 00 00 00 01 02 00 09",
            "00 01 00 00 00 03 01 97 02",
        ),
        "then register 0, which is 5 still": (read, "00 01 00 00 00 05 01 03 02 00 05"),
    }
    as_before = True
    for words, (request, expected) in cases.items():
        seen = await ask(port, request)
        right = seen == expected
        as_before &= right is (words == "write 9 to register 0 and read 100")
        print(f"{words}:\n  expected {expected}\n  seen     {seen or 'nothing'}")
    await server.shutdown()
    sys.exit(0 if as_before else 1)


asyncio.run(main())
PYTHON
"$folder/venv/bin/python" "$folder/server.py"
