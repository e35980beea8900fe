#!/usr/bin/env bash
# A client of dask.distributed that is given the address of something which accepts connections and
# says nothing does not come back, whatever its timeout: `distributed.comm.core.connect` bounds
# the connection and then reads the handshake without a bound. A wrong port of a machine behind a
# proxy, or a scheduler that is stopped, is enough. An address at which nobody listens is refused
# after the timeout, as it should be.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  dask==2026.8.0 distributed==2026.8.0
cat >"$folder/waits.py" <<'PYTHON'
import socket
import sys
import threading
import time

import distributed
from distributed import Client

silent = socket.create_server(("127.0.0.1", 0))
address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"


def connect():
    try:
        Client(address, timeout=1.0, set_as_default=False)
    except OSError as error:
        print("refused:", error)


thread = threading.Thread(target=connect, daemon=True)
began = time.monotonic()
thread.start()
thread.join(20.0)
print(f"distributed {distributed.__version__}, timeout 1 s:", end=" ")
print(f"{'still waiting' if thread.is_alive() else 'back'} after {time.monotonic() - began:.0f} s")
sys.stdout.flush()
__import__("os")._exit(0)
PYTHON
"$folder/venv/bin/python" "$folder/waits.py"
