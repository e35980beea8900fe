"""Blocks of the IEC 61131-3 world: CODESYS, TwinCAT, and the standard's own example."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

#: The step of the type TIME [s].
_TIME = 0.001
_AS_CONNECTED = "none: the gain is in the units of the variables that are connected"

BLOCKS = (
    VendorBlock(
        key="codesys-pid",
        vendor="CODESYS",
        name="PID (library Util)",
        equation="Y = Y_OFFSET + KP [e + 1/TN ∫ e dt + TV de/dt], e = SET_POINT − ACTUAL",
        form="isa",
        gain_in="engineering",
        parameters=(
            Parameter("KP", "gain"),
            Parameter("TN", "integral time", "s"),
            Parameter("TV", "derivative time", "s"),
        ),
        derivative_filter="none",
        anti_windup="Y is kept between Y_MIN and Y_MAX; what the integral does is not stated",
        scaling=_AS_CONNECTED,
        sources=(
            "CODESYS Util library, Controller, PID and PID_FIXCYCLE",
            "ABB Automation Builder 2.2, util.lib, PID",
        ),
        not_confirmed=("a switch for direct action: the gain's sign is taken",),
    ),
    VendorBlock(
        key="beckhoff-fb-ctrl-pid",
        vendor="Beckhoff",
        name="FB_CTRL_PID",
        equation="G(s) = Kp [1 + 1/(Tn s) + Tv s/(1 + Td s)]",
        form="isa",
        gain_in="engineering",
        parameters=(
            Parameter("fKp", "gain"),
            Parameter("tTn", "integral time", "s", _TIME),
            Parameter("tTv", "derivative time", "s", _TIME),
            Parameter("tTd", "filter time", "s", _TIME),
        ),
        weights=(1.0, 0.0),
        weight_choice=("bPInTheFeedbackPath", "FALSE", "TRUE"),
        derivative_on=("measurement", "error"),
        derivative_choice=("bDInTheFeedbackPath", "TRUE", "FALSE"),
        derivative_filter="settable",
        anti_windup="an anti-reset windup (ARW), with a choice bARWOnIPartOnly",
        scaling=_AS_CONNECTED,
        sources=(
            "TF4100 TwinCAT 3 Controller Toolbox, FB_CTRL_PID",
            "Tc2_Utilities, FB_BasicPID, for the damping time of the D-T1 part",
        ),
        not_confirmed=("a switch for direct action: the gain's sign is taken",),
    ),
    VendorBlock(
        key="iec-61131-3-pid",
        vendor="IEC 61131-3",
        name="PID (annex F; OpenPLC, matiec)",
        equation="XOUT = KP [ERROR + 1/TR ∫ ERROR dt + TD dERROR/dt], ERROR = PV − SP",
        form="isa",
        gain_in="engineering",
        parameters=(
            Parameter("KP", "gain"),
            Parameter("TR", "integral time", "s"),
            Parameter("TD", "derivative time", "s"),
        ),
        sign="opposite gain",
        derivative_filter="none",
        anti_windup="none, and no limits: put AUTO to FALSE at a limit, X0 the output over KP",
        scaling=_AS_CONNECTED,
        sources=("IEC 61131-3, second edition (final draft 2001), annex F, PID",),
    ),
)
