"""Yokogawa, Honeywell and Omron: one block each."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

BLOCKS = (
    VendorBlock(
        key="yokogawa-fieldbus-pid",
        vendor="Yokogawa",
        name="PID (FOUNDATION fieldbus)",
        equation="ΔMV = K [Δ(PV − SP) + ΔT/Ti (PV − SP) + Td/ΔT Δ(ΔPV)], in Auto with ΔPV first",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("GAIN", "gain", "", 0.0, 0.05, 20.0),
            Parameter("RESET", "integral time", "s", 0.0, 0.1, 10000.0),
            Parameter("RATE", "derivative time", "s", 0.0, 0.0),
        ),
        sign="switch",
        action=("CONTROL_OPTS, Direct Acting", "false", "true"),
        weights=(1.0, 0.0),
        weight_choice=("mode", "Cas (PI-D)", "Auto or RCas (I-PD)"),
        derivative_on=("measurement",),
        derivative_filter="none",
        anti_windup="velocity form: there is no integral that could wind up",
        scaling="give PV_SCALE and OUT_SCALE the ranges",
        sources=(
            "YVP110 Advanced Valve Positioner, IM 21B04C01-01E, 16.5 to 16.7",
            "ADMAG TI AXG, Fieldbus, IM 01E21A02-03EN, page 283",
        ),
    ),
    VendorBlock(
        key="honeywell-hc900-pid",
        vendor="Honeywell",
        name="HC900 PID",
        equation="PID A: gain, reset and rate act on SP − PV; PID B: only reset acts on SP",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("Prop Band", "proportional band", "%", 0.0, 0.1, 1000.0),
            Parameter("Gain", "gain"),
            Parameter("Reset", "integral time", "min", 0.0, 0.02, 50.0),
            Parameter("Reset (RPM)", "repeats", "1/min"),
        ),
        sign="switch",
        action=("Direction", "REVERSE", "DIRECT"),
        weights=(1.0, 0.0),
        weight_choice=("Control Algorithm", "PID A", "PID B"),
        derivative_on=(),
        anti_windup="not stated",
        scaling="give the ranges; enter the band or the gain, minutes or repeats, as configured",
        sources=(
            "HC900 Hybrid Control Designer Function Block Reference Guide, revision 11, 2/07, "
            "pages 273 and 281",
        ),
        not_confirmed_of_derivative=("whether its rate and reset interact, and its filter",),
    ),
    VendorBlock(
        key="omron-pidat",
        vendor="Omron",
        name="PIDAT (CS, CJ, CP)",
        equation=(
            "MV = Kp [1 + 1/(Ti s)] (F SP − PV) − Kp Td s/(1 + λ Td s) PV, "
            "F = [1 + (1 − α) Ti s]/(1 + Ti s), Kp = 100/P"
        ),
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("P", "proportional band", "%", 0.1, 0.1, 999.9),
            Parameter("Tik", "integral time", "s", 0.1, 0.1, 819.1),
            Parameter("Tdk", "derivative time", "s", 0.1, 0.0, 819.1),
            Parameter("α", "reduced setpoint weight", "", 0.01, 0.0, 0.99),
        ),
        sign="switch",
        action=("bit 00 of C+5", "0", "1"),
        weights=(),
        derivative_on=("measurement",),
        derivative_filter="unpublished",
        anti_windup="not stated",
        scaling="set the input and output range in bits; times with unit 9, in 0.1 s",
        sources=(
            "CS/CJ/NSJ Series Instructions Reference Manual, W474, page 655",
            "CJ1G Instructions, page 691; CP Programming Manual, 05/2007, pages 633 to 635",
            "NJ-series Instructions Reference Manual, W502, page 2-404, for the set point filter",
        ),
        not_confirmed=("that the set point filter of W502 is that of the older blocks",),
        not_confirmed_of_derivative=("its λ",),
    ),
)
