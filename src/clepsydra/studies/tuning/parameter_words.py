"""Tuned parameters and limits as a reader knows them: %/%, seconds, and names of loops."""

from __future__ import annotations

from clepsydra.base.signal import Signal, path
from clepsydra.base.units import from_si
from clepsydra.base.words import time_text
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid_keys import GAINS, SHORT_NAMES
from clepsydra.controllers.structure.pid_block import PidBlock
from clepsydra.designs.gain_units import percent_gain
from clepsydra.process.joined_unit import BESIDE
from clepsydra.process.process import Process
from clepsydra.scores.score_key import score_key
from clepsydra.studies.tuning.search_space import NumberWords


class ParameterWords(NumberWords):
    """The parameters of one controller in words.

    Examples
    --------
    >>> from clepsydra.designs.simc import design_simc
    >>> from clepsydra.linear.analysis import analyse
    >>> from clepsydra.process.reader import load_process
    >>> words = ParameterWords(design_simc(analyse(load_process("wet-well")).model))
    >>> words.name("level.proportional_gain"), words.value("level.proportional_gain", -125.0)
    ('level.gain', '2 %/%')
    """

    def __init__(self, controller: Controller) -> None:
        self._parameters = {parameter.name: parameter for parameter in controller.law.parameters}
        self._loops = {
            parameter.name: block
            for block in controller.law.blocks
            if isinstance(block, PidBlock)
            for parameter in block.parameters()
        }

    def name(self, parameter: str) -> str:
        """Return "level.gain" of a loop, as in a study file, or the law's own name."""
        if parameter not in self._loops:
            return parameter
        signal = self._parameters[parameter]
        return path(signal.owner, SHORT_NAMES.get(signal.part, signal.part))

    def value(self, parameter: str, value: float) -> str:
        """Return a value [the law's unit]; of a loop's gain without the sign of its action."""
        signal = self._parameters[parameter]
        if self._is_gain(parameter):
            block = self._loops[parameter]
            measured, moved = block.measurement, block.moved
            if measured.has_range and moved.has_range:
                shown = percent_gain(abs(value), measured, moved)
                return f"{shown:.4g} %/%{BESIDE[GAINS[signal.part]]}"
            return _quantity(signal, abs(value))
        if signal.unit == "s":
            return time_text(value)
        return _quantity(signal, value)

    def turns(self, parameter: str, value: float) -> bool:
        """Return whether `value` leaves a negative sign out, and larger is smaller."""
        return self._is_gain(parameter) and value < 0.0

    def _is_gain(self, parameter: str) -> bool:
        return parameter in self._loops and self._parameters[parameter].part in GAINS


def limit_words(name: str, limit: float, process: Process) -> str:
    """Return a limit of a score as a phrase.

    Parameters
    ----------
    name : str
        "total_variation[duty]"
    limit : float
        In the unit of the score; an overshoot in percent.
    process : Process

    Examples
    --------
    >>> from clepsydra.process.reader import load_process
    >>> limit_words("total_variation[duty]", 2.077, load_process("wet-well"))
    'total variation of duty at most 207.7 %'
    >>> limit_words("overshoot[level]", 10.0, load_process("wet-well"))
    'overshoot of level at most 10 %'
    >>> limit_words("lowest[well.level]", 1.5, load_process("wet-well"))
    'well.level at least 1.5 m'
    >>> limit_words("lowest_under_load[level]", 0.3, load_process("equalisation-tank"))
    'level at least 30 % under load'
    """
    score, signal = score_key(name)
    percent = score == "overshoot"
    shown = f"{limit:.4g} %" if percent else _quantity(process.signal(signal), limit)
    end, _, when = score.partition("_")
    if end in ("lowest", "highest"):
        words = f"{signal} at {'least' if end == 'lowest' else 'most'} {shown}"
        return " ".join([words, *when.split("_")]).rstrip()
    return f"{score.replace('_', ' ')} of {signal} at most {shown}"


def _quantity(signal: Signal, value: float) -> str:
    shown = f"{from_si(value, signal.unit, signal.shown_unit):.4g}"
    return shown if signal.shown_unit == "1" else f"{shown} {signal.shown_unit}"
