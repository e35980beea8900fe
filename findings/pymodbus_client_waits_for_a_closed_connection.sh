#!/usr/bin/env bash
# An asynchronous client of pymodbus whose server closes the connection in the middle of a request
# does not hear of it: `connection_lost` leaves the future of the answer as it is, so the request
# waits for its time-out, then "sends" it again three times into no connection, and waits each time.
# With the defaults of 3 s and 3 retries the end of a connection, which TCP tells at once, is told
# after 12 s. The synchronous client raises ConnectionException at once.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check pymodbus==3.16.1
cat >"$folder/client.py" <<'PYTHON'
import asyncio
import logging
import sys
import time

import pymodbus
from pymodbus.client import AsyncModbusTcpClient, ModbusTcpClient
from pymodbus.exceptions import ModbusException

logging.getLogger("pymodbus").addHandler(logging.NullHandler())


async def close(reader, writer):
    """Take one request, and close."""
    await reader.read(100)
    writer.close()


async def asynchronous(port):
    client = AsyncModbusTcpClient("127.0.0.1", port=port, reconnect_delay=0)
    await client.connect()
    try:
        await client.read_holding_registers(0)
    except ModbusException as error:
        return error
    finally:
        client.close()


def synchronous(port):
    client = ModbusTcpClient("127.0.0.1", port=port)
    try:
        client.read_holding_registers(0)
    except ModbusException as error:
        return error
    finally:
        client.close()


async def main():
    print("pymodbus", pymodbus.__version__)
    server = await asyncio.start_server(close, "127.0.0.1", 0)
    port = server.sockets[0].getsockname()[1]
    took = {}
    for name, ask in (
        ("synchronous", asyncio.to_thread(synchronous, port)),
        ("asynchronous", asynchronous(port)),
    ):
        began = time.monotonic()
        error = await ask
        took[name] = time.monotonic() - began
        print(f"{name}: {type(error).__name__} after {took[name]:.1f} s, expected below 1 s")
    server.close()
    return 0 if took["synchronous"] < 1.0 and took["asynchronous"] > 3.0 else 1


sys.exit(asyncio.run(main()))
PYTHON
"$folder/venv/bin/python" "$folder/client.py"
