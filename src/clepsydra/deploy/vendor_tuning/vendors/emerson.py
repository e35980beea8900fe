"""Emerson: the PID function block of DeltaV, in its two forms."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

_BOOK = "DeltaV Books Online, PID function block execution and parameters"
_WINDUP = "beyond ARW_HI_LIM or ARW_LO_LIM, 16 times faster reset on the way back"
_SCALING = "give PV_SCALE and OUT_SCALE the ranges; the block takes the gain from PV to OUT"
_ACTION = ("CONTROL_OPTS, Direct Acting", "off", "on")
_ALPHA = Parameter("ALPHA", "filter ratio", "", 0.0, 0.05, 1.0)

BLOCKS = (
    VendorBlock(
        key="emerson-deltav-standard",
        vendor="Emerson",
        name="DeltaV PID, standard form",
        equation="OUT = GAIN [P + 1/(RESET s) E + RATE s/(ALPHA RATE s + 1) D], E = SP − PV",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("GAIN", "gain"),
            Parameter("RESET", "integral time", "s"),
            Parameter("RATE", "derivative time", "s"),
            _ALPHA,
            Parameter("BETA", "setpoint weight", low=0.0, high=1.0),
            Parameter("GAMMA", "derivative weight", low=0.0, high=1.0),
        ),
        sign="switch",
        action=_ACTION,
        weights=(),
        derivative_on=("measurement", "error"),
        derivative_filter="settable",
        anti_windup=_WINDUP,
        scaling=f"{_SCALING}; STRUCTURE is the one with two degrees of freedom",
        sources=(_BOOK, "Fisher FIELDVUE DVC6200f, D103412X012, 07/2013, page 140, BETA and GAMMA"),
    ),
    VendorBlock(
        key="emerson-deltav-series",
        vendor="Emerson",
        name="DeltaV PID, series form",
        equation="OUT = GAIN [1 + RATE s/(ALPHA RATE s + 1)] [1 + 1/(RESET s)] E",
        form="series",
        gain_in="percent",
        parameters=(
            Parameter("GAIN", "gain"),
            Parameter("RESET", "integral time", "s"),
            Parameter("RATE", "derivative time", "s"),
            _ALPHA,
        ),
        sign="switch",
        action=_ACTION,
        derivative_on=("measurement", "error"),
        derivative_choice=(
            "STRUCTURE",
            "PI action on error, D action on PV",
            "PID action on error",
        ),
        derivative_filter="settable",
        anti_windup=_WINDUP,
        scaling=_SCALING,
        sources=(_BOOK, "the equation as Industrial Monitor Direct quotes it from the same book"),
        not_confirmed_of_derivative=(
            "with D action on PV, whether P and I take the PV with the lead: taken so",
        ),
    ),
)
