"""Tables 6 to 8 as printed: integral indices of C [kmol/m³] and V [m³] after the steps."""

from __future__ import annotations

#: PI control, optimal; f_out constant, f_in constant.
TABLE_6 = {
    ("IAE", "C"): ("1.242E-02", "2.258E-02"),
    ("IAE", "V"): ("1.304E-02", "5.000E-02"),
    ("ISE", "C"): ("1.170E-03", "1.027E-03"),
    ("ISE", "V"): ("5.379E-04", "1.670E-03"),
    ("ITAE", "C"): ("1.997E-03", "1.410E-03"),
    ("ITAE", "V"): ("1.997E-03", "2.505E-02"),
    ("IE", "C"): ("2.799E-06", "2.517E-06"),
    ("IE", "V"): ("-2.561E-15", "-2.465E-12"),
}
#: LQI control; f_out constant by hand and optimal, f_in constant by hand and optimal.
TABLE_7 = {
    ("IAE", "C"): ("0.398", "0.019", "0.415", "0.022"),
    ("IAE", "V"): ("0.098", "0.011", "0.149", "0.043"),
    ("ISE", "C"): ("0.064", "0.003", "0.068", "0.004"),
    ("ISE", "V"): ("0.006", "0.001", "0.010", "0.003"),
    ("ITAE", "C"): ("0.481", "0.001", "0.510", "0.002"),
    ("ITAE", "V"): ("0.067", "0.001", "0.161", "0.014"),
    ("IE", "C"): ("0.372", "0.019", "0.380", "0.019"),
    ("IE", "V"): ("0.097", "0.011", "0.140", "0.043"),
}
#: Fuzzy control.
TABLE_8 = {
    ("IAE", "C"): "8.80E-02",
    ("IAE", "V"): "8.73E-03",
    ("ISE", "C"): "1.42E-03",
    ("ISE", "V"): "5.75E-04",
    ("ITAE", "C"): "2.22E-04",
    ("ITAE", "V"): "5.15E-04",
    ("IE", "C"): "8.82E-03",
    ("IE", "V"): "8.73E-03",
}

#: IAE of C in Table 8 without its misprint, which is judged in its own row.
IAE_OF_C = 8.80e-3

Indices = dict[tuple[str, str], float]


def pi_indices() -> Indices:
    """Return the sizes in Table 6 with f_out constant."""
    return {key: abs(float(texts[0])) for key, texts in TABLE_6.items()}


def lqi_indices() -> Indices:
    """Return Table 7, optimal, with f_out constant."""
    return {key: float(texts[1]) for key, texts in TABLE_7.items()}


def fuzzy_indices() -> Indices:
    """Return Table 8, IAE of C with the exponent that its IE asks for."""
    return {key: float(text) for key, text in TABLE_8.items()} | {("IAE", "C"): IAE_OF_C}
