"""Every vendor's block once more: its transfer functions from its documents, in its own units.

Each function takes what an engineer would have entered, numbers by the vendor's names and the
switches, and returns what the block does to the setpoint and to minus the process value, both in
the units that the block computes with: percent of range, or those of the variables connected.
"""

MINUTE = 60.0


def isa(gain, integral, derivative, weight, on_error):
    """Return (to setpoint, to minus process value) from actions that are transfer functions."""
    to_process = gain * (1 + integral + derivative)
    to_setpoint = gain * (weight + integral + (derivative if on_error else 0))
    return to_setpoint, to_process


def pid_compact(v, said, s):
    a, ti, td = v.get("TdFiltRatio", 0), v["Ti"], v.get("Td", 0)
    gain = {"no": 1, "yes": -1}[said["Invert control logic"]] * v["Gain"]
    action = td * s / (a * td * s + 1)
    to_setpoint = gain * (v["PWeighting"] + 1 / (ti * s) + v.get("DWeighting", 0) * action)
    return to_setpoint, gain * (1 + 1 / (ti * s) + action)


def cont_c(v, said, s):
    lag = v.get("TD", 0) * s / (1 + v.get("TM_LAG", 0) * s)
    return isa(v["GAIN"], 1 / (v["TI"] * s), lag, 1, True)


def error_sign(said, name):
    return {"E = SP − PV": 1, "E = PV − SP": -1}[said[name]]


def pide(v, said, s, filter_time):
    """Both ways to enter gains, in minutes; the derivative's filter is given from outside."""
    lag = 1 / (1 + filter_time * s)
    if "KC" in v:
        proportional = v["KC"]
        integral = v["KC"] / (v["TI"] * MINUTE * s)
        derivative = v["KC"] * v.get("TD", 0) * MINUTE * s * lag
    else:
        proportional = v["KP"]
        integral = v["KI"] / MINUTE / s
        derivative = v.get("KD", 0) * MINUTE * s * lag
    sign = error_sign(said, "control action")
    weight = {"change in error": 1, "change in PV": 0}[said["PVEProportional"]]
    on_error = said.get("PVEDerivative") == "change in error"
    to_setpoint = weight * proportional + integral + (derivative if on_error else 0)
    return sign * to_setpoint, sign * (proportional + integral + derivative)


def logix_pid(v, said, s, filter_time):
    """Minutes with dependent gains, seconds with independent ones."""
    lag = 1 / (1 + filter_time * s)
    if "KC" in v:
        proportional = v["KC"]
        integral = v["KC"] / (v["Ti"] * MINUTE * s)
        derivative = v["KC"] * v.get("Td", 0) * MINUTE * s * lag
    else:
        proportional, integral = v["KP"], v["Ki"] / s
        derivative = v.get("Kd", 0) * s * lag
    sign = error_sign(said, "control action .CA")
    on_error = said.get("derivative of .DOE") == "error"
    to_setpoint = proportional + integral + (derivative if on_error else 0)
    return sign * to_setpoint, sign * (proportional + integral + derivative)


def micrologix(v, said, s):
    td = v.get("TD", 0) * MINUTE
    gain = error_sign(said, "control mode") * v["KC"]
    return isa(gain, 1 / (v["TI"] * MINUTE * s), td * s / (1 + td / 16 * s), 1, False)


def codesys(v, said, s):
    return isa(v["KP"], 1 / (v["TN"] * s), v.get("TV", 0) * s, 1, True)


def beckhoff(v, said, s):
    weight = {"FALSE": 1, "TRUE": 0}[said["bPInTheFeedbackPath"]]
    on_error = said.get("bDInTheFeedbackPath") == "FALSE"
    lag = v.get("tTv", 0) * s / (1 + v.get("tTd", 0) * s)
    return isa(v["fKp"], 1 / (v["tTn"] * s), lag, weight, on_error)


def iec(v, said, s):
    """ERROR = PV − SP, so that what acts on minus the process value is −KP (…)."""
    whole = v["KP"] * (1 + 1 / (v["TR"] * s) + v.get("TD", 0) * s)
    return -whole, -whole


def schneider(v, said, s):
    lag = v.get("TD", 0) * s / (1 + v.get("TD_LAG", 0) * s)
    return isa(v["GAIN"], 1 / (v["TI"] * s), lag, 1, said.get("D_ON_X") == "0")


def direct(said):
    return -1 if said["CONTROL_OPTS, Direct Acting"] in ("on", "true") else 1


def deltav_standard(v, said, s):
    td = v.get("RATE", 0)
    action = td * s / (v.get("ALPHA", 0) * td * s + 1)
    gain = direct(said) * v["GAIN"]
    integral = 1 / (v["RESET"] * s)
    to_setpoint = gain * (v["BETA"] + integral + v.get("GAMMA", 0) * action)
    return to_setpoint, gain * (1 + integral + action)


def deltav_series(v, said, s):
    td, gain = v.get("RATE", 0), direct(said) * v["GAIN"]
    lead = 1 + td * s / (v.get("ALPHA", 0) * td * s + 1)
    reset = 1 + 1 / (v["RESET"] * s)
    on_error = said.get("STRUCTURE") == "PID action on error"
    return gain * reset * (lead if on_error else 1), gain * reset * lead


def yokogawa(v, said, s):
    weight = 1 if said["mode"] == "Cas (PI-D)" else 0
    gain = direct(said) * v["GAIN"]
    return isa(gain, 1 / (v["RESET"] * s), v.get("RATE", 0) * s, weight, False)


def hc900_by_band(v, said, s):
    gain = {"REVERSE": 1, "DIRECT": -1}[said["Direction"]] * 100 / v["Prop Band"]
    weight = {"PID A": 1, "PID B": 0}[said["Control Algorithm"]]
    return isa(gain, 1 / (v["Reset"] * MINUTE * s), 0, weight, False)


def hc900_by_gain(v, said, s):
    gain = {"REVERSE": 1, "DIRECT": -1}[said["Direction"]] * v["Gain"]
    weight = {"PID A": 1, "PID B": 0}[said["Control Algorithm"]]
    return isa(gain, v["Reset (RPM)"] / MINUTE / s, 0, weight, False)


def omron(v, said, s, filter_time):
    gain = {"0": 1, "1": -1}[said["bit 00 of C+5"]] * 100 / v["P"]
    ti = v["Tik"]
    set_point_filter = (1 + (1 - v["α"]) * ti * s) / (1 + ti * s)
    whole = gain * (1 + 1 / (ti * s))
    derivative = gain * v.get("Tdk", 0) * s / (1 + filter_time * s)
    return whole * set_point_filter, whole + derivative


#: Those whose derivative filter is not published get the controller's.
UNPUBLISHED = {
    "rockwell-pide-dependent": pide,
    "rockwell-pide-independent": pide,
    "rockwell-pid-dependent": logix_pid,
    "rockwell-pid-independent": logix_pid,
    "omron-pidat": omron,
}
DOCUMENTED = {
    "siemens-pid-compact": [pid_compact],
    "siemens-cont-c": [cont_c],
    "rockwell-micrologix": [micrologix],
    "codesys-pid": [codesys],
    "beckhoff-fb-ctrl-pid": [beckhoff],
    "iec-61131-3-pid": [iec],
    "schneider-pid1": [schneider],
    "emerson-deltav-standard": [deltav_standard],
    "emerson-deltav-series": [deltav_series],
    "yokogawa-fieldbus-pid": [yokogawa],
    "honeywell-hc900-pid": [hc900_by_band, hc900_by_gain],
}


def documented(key, settings, choices, filter_time):
    """Return the transfer functions of a filled block, one pair for each way to enter it."""
    numbers = {setting.name: float(setting.text) for setting in settings}
    said = dict(choices)
    if key in UNPUBLISHED:
        return [lambda s: UNPUBLISHED[key](numbers, said, s, filter_time)]
    return [lambda s, way=way: way(numbers, said, s) for way in DOCUMENTED[key]]
