"""Exported controllers, each compiled once."""

import pytest
from plc_bench import READY
from tools import need_compiler, without

from clepsydra.hil.building import Absent, c_image, structured_text_image


@pytest.fixture(scope="session")
def compiled_c(tmp_path_factory):
    """PI by SIMC on the quadruple tank, as exported C."""
    need_compiler()
    return c_image(READY, tmp_path_factory.mktemp("c"))


@pytest.fixture(scope="session")
def by_matiec(tmp_path_factory):
    """The same as Structured Text."""
    try:
        return structured_text_image(READY, tmp_path_factory.mktemp("st"))
    except Absent as reason:
        without(str(reason), "CLEPSYDRA_REQUIRE_ST_COMPILERS")
