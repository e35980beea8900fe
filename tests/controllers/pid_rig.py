"""A law driven by names, and the PID controller written once more from its description."""

import copy
from functools import cache

from law_function import by_path, function_of

from clepsydra import PidForm
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.pid import multiloop_pid_law

MANUAL, AUTOMATIC, TRACKING = 0, 1, 2
ANTI_WINDUPS = ("back_calculation", "conditional_integration", "clamping", "none")
LOW, HIGH = 0.0, 100.0
#: The largest bump that is allowed, in the unit of the output.
BUMP = 1e-9 * (HIGH - LOW)


def forms(error="linear", **options):
    """Every algorithm with every choice of actions, and the derivative on either signal."""
    algorithms = ("isa", "parallel") + (("series", "velocity") if error == "linear" else ())
    return [
        PidForm(actions, algorithm, derivative_on, error, **options)
        for algorithm in algorithms
        for actions in (("PI", "PID") if algorithm == "velocity" else ("P", "PI", "PD", "PID"))
        for derivative_on in (("measurement", "error") if "D" in actions else ("measurement",))
    ]


def winding_forms(**options):
    """Every form, and those that an anti-windup makes a difference to with each of them."""
    return [
        form
        for anti_windup in ANTI_WINDUPS
        for form in forms(anti_windup=anti_windup, **options)
        if anti_windup == ANTI_WINDUPS[0] or (form.has_integral and form.algorithm != "velocity")
    ]


def name_of(form):
    words = [form.algorithm, form.actions]
    if form.has_derivative:
        words += ["on", form.derivative_on]
    if form.error != "linear":
        words.append(form.error)
    if form.anti_windup != ANTI_WINDUPS[0]:
        words.append(form.anti_windup)
    return "-".join(words)


def settings(
    form, *, gain, integral_time=10.0, derivative_time=2.0, derivative_filter=5.0, weight=1.0
):
    """Parameters of loop 1 with the same meaning in every form: isa gain and times [s]."""
    if form.algorithm == "parallel":
        values = {
            "level_1.proportional_gain": gain,
            "level_1.integral_gain": gain / integral_time,
            "level_1.derivative_gain": gain * derivative_time,
            "level_1.filter_time": derivative_time / derivative_filter,
        }
    else:
        values = {
            "level_1.proportional_gain": gain,
            "level_1.integral_time": integral_time,
            "level_1.derivative_time": derivative_time,
            "level_1.derivative_filter": derivative_filter,
        }
    values |= {"level_1.setpoint_weight": weight, "level_1.tracking_time": 20.0}
    return values | {"pump_1.low_limit": LOW, "pump_1.high_limit": HIGH}


class Scans:
    """A law that starts at rest. Inputs and parameters keep their values until changed."""

    def __init__(self, law, values, **inputs):
        self.law = law
        known = [parameter.name for parameter in law.parameters]
        self.values = {parameter.name: parameter.initial for parameter in law.parameters}
        given = by_path(law.parameters, values)
        self.values |= {name: value for name, value in given.items() if name in known}
        self.inputs = {signal.name: signal.initial for signal in law.inputs}
        self.give(inputs)
        self.state = state_at_rest(law, self.values, self.inputs)

    def give(self, inputs):
        inputs = by_path(self.law.inputs, inputs)
        assert set(inputs) <= set(self.inputs), sorted(set(inputs) - set(self.inputs))
        self.inputs |= inputs

    def set(self, **parameters):
        parameters = by_path(self.law.parameters, parameters)
        assert set(parameters) <= set(self.values), sorted(set(parameters) - set(self.values))
        self.values |= parameters

    def scan(self, **inputs):
        """Run one sample and return the outputs by name."""
        self.give(inputs)
        next_state, outputs, _ = function_of(self.law)(
            list(self.state.values()), list(self.inputs.values()), list(self.values.values())
        )
        self.state = dict(zip(self.state, next_state, strict=True))
        return dict(zip([signal.name for signal in self.law.outputs], outputs, strict=True))

    def moved(self, **inputs):
        """Run one sample and return the first manipulated variable."""
        return self.scan(**inputs)[self.law.outputs[0].name]

    def twin(self):
        """Another instance in the same state."""
        other = copy.copy(self)
        other.values, other.inputs = dict(self.values), dict(self.inputs)
        other.state = dict(self.state)
        return other


@cache
def law_of(form, rate_limited):
    return multiloop_pid_law(["level_1"], ["pump_1"], form, rate_limited=rate_limited)


def one_loop(form, values, *, rest=5.0, output=50.0, rate_limited=False, **inputs):
    """One PID loop at rest at a level, in automatic."""
    law = law_of(form, rate_limited)
    given = {
        "level_1.sp": rest,
        "level_1.pv": rest,
        "pump_1.tracking": output,
        "pump_1.manual": output,
    }
    return Scans(law, values, **by_path(law.inputs, given | inputs))


class PlainPid:
    """The positional forms from the equations of `PidForm`: what does not come from the integral,
    and what the integral gains; the derivative by backward differences."""

    def __init__(self, form, values, *, rest):
        self.form, self.values = form, values
        self.filtered = {"measurement": rest, "error": 0.0}[form.derivative_on]

    def sample(self, setpoint, measurement, time_step):
        """Return the nonintegral part and the increment of the integral, and advance the filter."""
        form, v, error = self.form, self.values, setpoint - measurement
        gain = v["level_1.proportional_gain"]
        shared = v["level_1.setpoint_weight"] * setpoint - measurement
        parallel = form.algorithm == "parallel"
        rate = 0.0
        if form.has_derivative:
            time = (
                v["level_1.filter_time"]
                if parallel
                else v["level_1.derivative_time"] / v["level_1.derivative_filter"]
            )
            signal = measurement if form.derivative_on == "measurement" else error
            rate = (signal - self.filtered) / (time + time_step)
            self.filtered += time_step * rate
            rate = -rate if form.derivative_on == "measurement" else rate
        if parallel:
            integral_gain = v["level_1.integral_gain"] if form.has_integral else 0.0
            derivative_gain = v["level_1.derivative_gain"] if form.has_derivative else 0.0
            part = gain * shared + derivative_gain * rate
        else:
            integral_gain = gain / v["level_1.integral_time"] if form.has_integral else 0.0
            part = gain * (
                shared + (v["level_1.derivative_time"] * rate if form.has_derivative else 0.0)
            )
            if form.algorithm == "series" and form.has_derivative:
                error += v["level_1.derivative_time"] * rate
        return part, time_step * integral_gain * error
