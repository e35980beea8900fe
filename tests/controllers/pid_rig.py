"""A law driven by names, and the PID controller written once more from its description."""

import copy
from functools import cache

from law_function import function_of

from clepsydra import PidForm
from clepsydra.controllers.at_rest import state_at_rest
from clepsydra.controllers.multiloop_pid import multiloop_pid_law

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
            "proportional_gain_1": gain,
            "integral_gain_1": gain / integral_time,
            "derivative_gain_1": gain * derivative_time,
            "filter_time_1": derivative_time / derivative_filter,
        }
    else:
        values = {
            "proportional_gain_1": gain,
            "integral_time_1": integral_time,
            "derivative_time_1": derivative_time,
            "derivative_filter_1": derivative_filter,
        }
    values |= {"setpoint_weight_1": weight, "tracking_time_1": 20.0}
    return values | {"low_limit_1": LOW, "high_limit_1": HIGH}


class Scans:
    """A law that starts at rest. Inputs and parameters keep their values until changed."""

    def __init__(self, law, values, **inputs):
        self.law = law
        known = [parameter.name for parameter in law.parameters]
        self.values = {parameter.name: parameter.initial for parameter in law.parameters}
        self.values |= {name: value for name, value in values.items() if name in known}
        self.inputs = {signal.name: signal.initial for signal in law.inputs}
        self.give(inputs)
        self.state = state_at_rest(law, self.values, self.inputs)

    def give(self, inputs):
        assert set(inputs) <= set(self.inputs), sorted(set(inputs) - set(self.inputs))
        self.inputs |= inputs

    def set(self, **parameters):
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
        return self.scan(**inputs)["manipulated_1"]

    def twin(self):
        """Another instance in the same state."""
        other = copy.copy(self)
        other.values, other.inputs = dict(self.values), dict(self.inputs)
        other.state = dict(self.state)
        return other


@cache
def law_of(form, rate_limited):
    return multiloop_pid_law(1, form, rate_limited=rate_limited)


def one_loop(form, values, *, rest=5.0, output=50.0, rate_limited=False, **inputs):
    """One PID loop at rest at a level, in automatic."""
    law = law_of(form, rate_limited)
    given = {"setpoint_1": rest, "measurement_1": rest, "tracking_1": output, "manual_1": output}
    return Scans(law, values, **(given | inputs))


class PlainPid:
    """The positional forms from the equations of `PidForm`: what does not come from the integral,
    and what the integral gains; the derivative by backward differences."""

    def __init__(self, form, values, *, rest):
        self.form, self.values = form, values
        self.filtered = {"measurement": rest, "error": 0.0}[form.derivative_on]

    def sample(self, setpoint, measurement, time_step):
        """Return the nonintegral part and the increment of the integral, and advance the filter."""
        form, v, error = self.form, self.values, setpoint - measurement
        gain = v["proportional_gain_1"]
        shared = v["setpoint_weight_1"] * setpoint - measurement
        parallel = form.algorithm == "parallel"
        rate = 0.0
        if form.has_derivative:
            time = (
                v["filter_time_1"]
                if parallel
                else v["derivative_time_1"] / v["derivative_filter_1"]
            )
            signal = measurement if form.derivative_on == "measurement" else error
            rate = (signal - self.filtered) / (time + time_step)
            self.filtered += time_step * rate
            rate = -rate if form.derivative_on == "measurement" else rate
        if parallel:
            integral_gain = v["integral_gain_1"] if form.has_integral else 0.0
            derivative_gain = v["derivative_gain_1"] if form.has_derivative else 0.0
            part = gain * shared + derivative_gain * rate
        else:
            integral_gain = gain / v["integral_time_1"] if form.has_integral else 0.0
            part = gain * (shared + (v["derivative_time_1"] * rate if form.has_derivative else 0.0))
            if form.algorithm == "series" and form.has_derivative:
                error += v["derivative_time_1"] * rate
        return part, time_step * integral_gain * error
