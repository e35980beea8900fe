"""A rig with its door of OPC UA, for the tests of one file."""

import pytest
from tools import need


@pytest.fixture(autouse=True)
def _packages():
    need("asyncua", "cryptography")


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    need("asyncua", "cryptography")
    from rig.opc_ua.held_rig import held_rig

    with held_rig(tmp_path_factory.mktemp("rig")) as found:
        found.show()
        yield found
