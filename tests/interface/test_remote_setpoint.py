"""Loops whose setpoint a host computer may give."""

import numpy as np
import pytest

import clepsydra as cl


@pytest.fixture(scope="module")
def plant():
    return cl.load("quadruple-tank")


@pytest.fixture(scope="module")
def remote(plant):
    return cl.design.simc(plant, form=cl.PidForm(remote_setpoint=True))


def test_until_it_is_in_force_the_loops_are_the_usual_ones(plant, remote):
    event = [cl.step("level_1", "+1 V", at="10 s")]
    usual, found = (
        cl.simulate(plant, controller, event, duration="1 min").to_pandas()["pump_1"]
        for controller in (cl.design.simc(plant), remote)
    )
    np.testing.assert_allclose(found, usual, rtol=0, atol=1e-12)


def test_the_exported_block_takes_it(plant, remote, tmp_path):
    written = cl.export(remote, plant, tmp_path, to="st")
    text = next(path for path in written.files if not path.stem.endswith("test")).read_text()
    for name in ("level_1_remote_setpoint", "level_2_setpoint_source"):
        assert f"{name} :" in text.split("FUNCTION_BLOCK ")[-1].partition("END_VAR")[0]
