"""Schneider Electric: PID of EcoStruxure Control Expert."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

BLOCKS = (
    VendorBlock(
        key="schneider-pid1",
        vendor="Schneider",
        name="PID1 (Control Expert)",
        equation="Y = GAIN [ERR + 1/(TI s) ERR + TD s/(1 + TD_LAG s) ERR], ERR = SP − PV",
        form="isa",
        gain_in="engineering",
        parameters=(
            Parameter("GAIN", "gain"),
            Parameter("TI", "integral time", "s"),
            Parameter("TD", "derivative time", "s"),
            Parameter("TD_LAG", "filter time", "s"),
        ),
        derivative_on=("measurement", "error"),
        derivative_choice=("D_ON_X", "1", "0"),
        derivative_filter="settable",
        anti_windup="the integral is corrected so that Y without its D part stays within limits",
        scaling="none: the gain is in the units of the variables that are connected",
        sources=("Control Expert help, controllers with GAIN, TI, TD and TD_LAG, D-SG-0011261",),
        not_confirmed=("the block's name, which that page of the help does not repeat",),
    ),
)
