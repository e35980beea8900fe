"""What the designs by a published rule share: each loop by the rule, then all together."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal, NamedTuple

from clepsydra.designs.arguments.argument import flag
from clepsydra.designs.loops.pid_settings import PidSettings
from clepsydra.designs.loops.words import by_pair
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT, note_on_peak
from clepsydra.linear.control_authority import DESIGN_STEP

if TYPE_CHECKING:
    from clepsydra.controllers.controller import Controller
    from clepsydra.controllers.pid_form import PidForm
    from clepsydra.designs.loops.pairing import PairedLoop, Pairing
    from clepsydra.linear.linear_model import LinearModel

RuleActions = Literal["PI", "PID"]
#: A gain this many times what a setpoint step of a tenth of the range allows is remarked on.
HIGH_GAIN = 3.0
#: A loop, the delay of its sampling [s] and the actions to its settings and what they came from.
Rule = Callable[["PairedLoop", float, RuleActions], tuple[PidSettings, str]]
AS_PUBLISHED = flag(
    "as_published",
    "`true` keeps the settings of a rule, `false` slows the loops down until max|S| is 2",
)


class PublishedRule(NamedTuple):
    """A tuning rule without a parameter to tune.

    Parameters
    ----------
    method : str
        "AMIGO"
    source : str
        "Åström and Hägglund 2006"
    advice : str
        What the reader must know about the rule.

    Examples
    --------
    >>> PublishedRule("by hand", "ours", lambda loop, delay, actions: (PidSettings(1.0), "")).advice
    ''
    """

    method: str
    source: str
    settings_of: Rule
    advice: str = ""

    def designed(
        self, model: LinearModel, pairing: Pairing | None, form: PidForm | None, as_published: bool
    ) -> Controller:
        """Design a controller for each pair, then slow all down until they bear each other.

        Parameters
        ----------
        form : PidForm or None
            PI in ISA form for None.
        as_published : bool
            Keep the settings of the rule.

        Raises
        ------
        NotApplicable
            The rule does not apply to an element, the loops are unstable together, or a setting is
            outside of what a controller takes.
        InputError
            The model has no operating point, the pairing is no pairing of the model, or the form is
            neither PI nor PID.

        Examples
        --------
        >>> import clepsydra as cl
        >>> analysis = cl.load("equalisation-tank").analysis
        >>> guess = PublishedRule("by hand", "ours", lambda *_: (PidSettings(-1.0, 9e4), "a guess"))
        >>> guess.designed(analysis.model, analysis.pairing, None, as_published=True).notes
        ('The rule was given, level by outflow: a guess.',)
        """
        from clepsydra.designs.loops.multiloop import MultiloopPid

        together = MultiloopPid(model, pairing, form, self.method)
        found = together.each(lambda loop: self.settings_of(loop, together.delay, together.actions))
        settings, origins = zip(*found, strict=True)
        notes = [f"The rule was given, {by_pair(together.loops, origins)}."]
        if as_published:
            tuned = together.as_given(settings, "the settings of the rule")
            notes += note_on_peak(tuned.peak, "lower the gain")
            notes += [self.advice] if self.advice else []
        else:
            tuned = together.detuned(settings)
            if tuned.factor > 1.0:
                notes.append(
                    f"The gains of the rule were divided by {tuned.factor:.3g} and its integral "
                    "times multiplied by it, so that the loops together keep a sensitivity peak of "
                    f"{SENSITIVITY_LIMIT:g}."
                )
        notes += [
            f"{loop.pair}: its gain is so high that a setpoint step of "
            f"{100.0 * DESIGN_STEP * loop.largest_gain / abs(setting.gain):.2g} % of the range "
            "saturates the input; the rule looks at delays alone."
            for loop, setting in zip(together.loops, tuned.design, strict=True)
            if abs(setting.gain) > HIGH_GAIN * loop.largest_gain
        ]
        return together.controller(tuned, f"{self.method} ({self.source})", notes)
