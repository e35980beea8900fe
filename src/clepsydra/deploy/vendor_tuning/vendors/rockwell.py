"""Rockwell Automation: PIDE and PID of Logix 5000, PID of MicroLogix and SLC 500."""

from __future__ import annotations

from clepsydra.deploy.vendor_tuning.vendor_block import Parameter, VendorBlock

_PIDE = "LOGIX 5000 Controllers Process Control Instructions, 1756-RM006K-EN-P, 11/2018"
_LOGIX = "Logix5000 Controllers General Instructions, 1756-RM003I-EN-P, 01/2007, pages 509 and 510"
_LOGIX_SETTINGS = "the same, 1756-RM003N-EN-P, 10/2011, pages 517 and 519"
_ACTION = ("E = SP − PV", "E = PV − SP")
_FREEZES = "the integral stands still while CV is at .MAXO or .MINO"
_PIDE_SCALING = "give the PVEU and CVEU ranges; errors are in percent of span, CV in %"

BLOCKS = (
    VendorBlock(
        key="rockwell-pide-dependent",
        vendor="Rockwell",
        name="PIDE, dependent gains",
        equation="ΔCV = KC [ΔE + Δt/(60 TI) E + 60 TD Δ²(−PV)/Δt], in percent of span",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("KC", "gain"),
            Parameter("TI", "integral time", "min"),
            Parameter("TD", "derivative time", "min"),
        ),
        sign="switch",
        action=("control action", *_ACTION),
        weights=(1.0, 0.0),
        weight_choice=("PVEProportional", "change in error", "change in PV"),
        derivative_on=("measurement", "error"),
        derivative_choice=("PVEDerivative", "change in PV", "change in error"),
        derivative_filter="unpublished",
        anti_windup="velocity form: there is no integral that could wind up",
        scaling=_PIDE_SCALING,
        sources=(f"{_PIDE}, pages 80 and 81",),
        not_confirmed_of_derivative=("the time constant of its derivative smoothing",),
    ),
    VendorBlock(
        key="rockwell-pide-independent",
        vendor="Rockwell",
        name="PIDE, independent gains",
        equation="ΔCV = KP ΔE + KI Δt/60 E + 60 KD Δ²(−PV)/Δt, in percent of span",
        form="parallel",
        gain_in="percent",
        parameters=(
            Parameter("KP", "gain"),
            Parameter("KI", "integral gain", "1/min"),
            Parameter("KD", "derivative gain", "min"),
        ),
        sign="switch",
        action=("control action", *_ACTION),
        weights=(1.0, 0.0),
        weight_choice=("PVEProportional", "change in error", "change in PV"),
        derivative_on=("measurement", "error"),
        derivative_choice=("PVEDerivative", "change in PV", "change in error"),
        derivative_filter="unpublished",
        anti_windup="velocity form: there is no integral that could wind up",
        scaling=_PIDE_SCALING,
        sources=(f"{_PIDE}, pages 80 and 81",),
        not_confirmed_of_derivative=("the time constant of its derivative smoothing",),
    ),
    VendorBlock(
        key="rockwell-pid-dependent",
        vendor="Rockwell",
        name="Logix PID, dependent gains",
        equation="CV = KC [E + 1/Ti ∫ E dt + Td dE/dt] + BIAS, or with −dPV/dt for dE/dt",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("KC", "gain"),
            Parameter("Ti", "integral time", "min"),
            Parameter("Td", "derivative time", "min"),
        ),
        sign="switch",
        action=("control action .CA", *_ACTION),
        derivative_on=("measurement", "error"),
        derivative_choice=("derivative of .DOE", "PV", "error"),
        derivative_filter="unpublished",
        anti_windup=_FREEZES,
        scaling="give the scales of PV and CV; the gain has no unit",
        sources=(_LOGIX, _LOGIX_SETTINGS),
        not_confirmed_of_derivative=(
            "the time constant of its derivative smoothing (.NDF turns it off)",
        ),
    ),
    VendorBlock(
        key="rockwell-pid-independent",
        vendor="Rockwell",
        name="Logix PID, independent gains",
        equation="CV = KP E + Ki ∫ E dt + Kd dE/dt + BIAS, or with −dPV/dt for dE/dt",
        form="parallel",
        gain_in="percent",
        parameters=(
            Parameter("KP", "gain"),
            Parameter("Ki", "integral gain", "1/s"),
            Parameter("Kd", "derivative gain", "s"),
        ),
        sign="switch",
        action=("control action .CA", *_ACTION),
        derivative_on=("measurement", "error"),
        derivative_choice=("derivative of .DOE", "PV", "error"),
        derivative_filter="unpublished",
        anti_windup=_FREEZES,
        scaling="give the scales of PV and CV; the gain has no unit",
        sources=(_LOGIX, _LOGIX_SETTINGS),
        not_confirmed_of_derivative=(
            "the time constant of its derivative smoothing (.NDF turns it off)",
        ),
    ),
    VendorBlock(
        key="rockwell-micrologix",
        vendor="Rockwell",
        name="PID of MicroLogix and SLC 500",
        equation="CV = KC [E + 1/TI ∫ E dt + TD d(PV)/dt] + bias, derivative filtered at TD/16",
        form="isa",
        gain_in="percent",
        parameters=(
            Parameter("KC", "gain", "", 0.01, 0.01, 327.67),
            Parameter("TI", "integral time", "min", 0.01, 0.01, 327.67),
            Parameter("TD", "derivative time", "min", 0.01, 0.01, 327.67),
        ),
        sign="switch",
        action=("control mode", *_ACTION),
        derivative_on=("measurement",),
        derivative_filter=16.0,
        anti_windup="not stated",
        scaling="set the bit RG to 1 for these steps and ranges; the gain has no unit",
        sources=(
            "MicroLogix 1100 Instruction Set, 1763-RM001C-EN-P, 10/2009, page 280",
            "MicroLogix 1200 and 1500 Instruction Set, 1762-RM001C-EN-P, pages 19-2 and 19-9",
            "SLC 500 Instruction Set, 1747-RM001G-EN-P, 11/2008, pages 9-2 and 9-6",
        ),
        not_confirmed=("which setting chooses the control action",),
    ),
)
