"""Engine, C and Structured Text of variable-structure PID, equal in every bit."""

import numpy as np
import pytest
from deployed import run_alike
from plants import designed
from test_proof_of_structures import scans, uneven

from clepsydra import PidForm
from clepsydra.program.defaults import with_defaults

FORMS = {
    "isa": PidForm("PID"),
    "on-error": PidForm("PID", derivative_on="error"),
    "parallel": PidForm("PI", "parallel"),
    "series": PidForm("PID", "series", setpoint_ramp=True),
    "gap": PidForm("PI", error="gap"),
}

pytestmark = pytest.mark.thorough


@pytest.mark.parametrize("name", FORMS)
def test_every_form(name, tmp_path):
    program = designed("variable_structure_pid", "three-tanks", form=FORMS[name]).program()
    values = uneven(program, 7) | {
        "feed.low_limit": 0.0, "feed.high_limit": 9.0, "level_3.saturation_rate": 0.37,
    }  # fmt: skip
    program = with_defaults(program, values)
    inputs = scans(program, seed=8)
    engine = run_alike(program, tmp_path, inputs)
    word = engine[:, 1].astype(int)
    for bit in (1, 2, 4, 8, 16, 32, 64):
        assert np.any(word & bit) and not np.all(word & bit), bit
    names = [entry.name for entry in program.state]
    integral = engine[:, len(program.outputs) + names.index("level_3.integral")]
    assert len(np.unique(integral)) > 100
