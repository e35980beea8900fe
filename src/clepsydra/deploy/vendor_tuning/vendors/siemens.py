"""Siemens: PID_Compact of the S7-1200 and S7-1500, CONT_C of the S7-300 and S7-400."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

_MANUAL = "PID control, Function Manual, A5E35300227-AC, 03/2017"
#: The step of the type TIME [s].
_TIME = 0.001

BLOCKS = (
    VendorBlock(
        key="siemens-pid-compact",
        vendor="Siemens",
        name="PID_Compact",
        equation="y = Kp [(b w − x) + 1/(TI s) (w − x) + TD s/(a TD s + 1) (c w − x)]",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("Gain", "gain"),
            Parameter("Ti", "integral time", "s"),
            Parameter("Td", "derivative time", "s"),
            Parameter("TdFiltRatio", "filter ratio", low=0.0),
            Parameter("PWeighting", "setpoint weight", low=0.0, high=1.0),
            Parameter("DWeighting", "derivative weight", low=0.0, high=1.0),
        ),
        sign="switch",
        action=("Invert control logic", "no", "yes"),
        weights=(),
        derivative_on=("measurement", "error"),
        derivative_filter="settable",
        anti_windup="it has one; the method is not stated",
        scaling=(
            "scale Input and Setpoint to 0 to 100 % of the measurement's range; Output is in %"
        ),
        sources=(
            "S7-1200 Programmable controller, System Manual, A5E02486680-06, 04/2012, 9.2.2",
            f"{_MANUAL}, page 261",
            "STEP 7 information system V20, PID_Compact, control mode",
        ),
        not_confirmed=(
            "whether an Input in another unit is taken to percent before the gain acts",
        ),
    ),
    VendorBlock(
        key="siemens-cont-c",
        vendor="Siemens",
        name="CONT_C (FB 41)",
        equation="LMN = GAIN [ER + 1/(TI s) ER + TD s/(1 + TM_LAG s) ER], ER = SP − PV",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("GAIN", "gain"),
            Parameter("TI", "integral time", "s", _TIME),
            Parameter("TD", "derivative time", "s", _TIME),
            Parameter("TM_LAG", "filter time", "s", _TIME),
        ),
        derivative_on=("error",),
        derivative_filter="settable",
        anti_windup="not stated",
        scaling="give SP_INT and PV_IN in percent of the measurement's range; LMN is in %",
        sources=(
            "Standard Software for S7-300 and S7-400, PID Control, C79000-G7076-C516-01",
            f"{_MANUAL}, 9.4",
        ),
        not_confirmed_of_derivative=(
            "that TM_LAG is a first-order lag of the D part, as its name says",
        ),
    ),
)
