"""Every model of one output, ranked, with the one to use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.base.signal import Signal
from clepsydra.base.words import time_text
from clepsydra.identification.arx_fitted import arx_model
from clepsydra.identification.fitted_model import OUTWEIGHED, FittedModel
from clepsydra.identification.ranking import RANKING_RULE, ranked
from clepsydra.identification.record import Record
from clepsydra.identification.structures import STRUCTURES
from clepsydra.identification.transfer_model import transfer_model
from clepsydra.identification.validation import USEFUL

#: What moves by less than this share stands still.
_STILL = 1e-9
#: A column with no more different values than this share of the rows moves in steps, as inputs do.
_STEPS = 0.1
_FAILS = "its residuals are still correlated with the input"


@dataclass(frozen=True, eq=False)
class Identification:
    """What a record tells of how one input moves one output.

    Parameters
    ----------
    record : Record
    manipulated, output : Signal
    models : tuple of FittedModel
        The one to use first.
    refused : tuple of (name, reason)
        Models that could not be fitted.
    warnings : tuple of str
        What to watch.
    """

    record: Record
    manipulated: Signal
    output: Signal
    models: tuple[FittedModel, ...]
    refused: tuple[tuple[str, str], ...]
    warnings: tuple[str, ...]

    @property
    def best(self) -> FittedModel:
        """The first of the models: the one to use, unless its `doubt` says not to."""
        return self.models[0]

    @property
    def for_control(self) -> FittedModel | None:
        """The best model that settings follow from; None where none is useful."""
        fitting = [m for m in self.models if m.settings is not None and m.doubt is None]
        return fitting[0] if fitting else None

    @property
    def verdict(self) -> str:
        """Which model to use, and how well it tells the held-back third, in words."""
        best = self.best
        if best.doubt is not None:
            return f"Use none of these models: {self._untold()}."
        told = ": ".join(filter(None, [best.name, best.numbers]))
        words = f"Use {told}. It explains {best.validated:.1f} % of the "
        words += f"held-back third of {self.output.name}"
        ahead = max(self.models, key=lambda model: model.validated)
        if ahead is not best and ahead.validated > best.validated:
            more = ahead.validated - best.validated
            points = "less than a tenth of a point" if more < 0.1 else f"{more:.1f} points"
            words += f"; {ahead.name} explains {points} more, {_against(ahead, best)}"
        words += "."
        if not best.tests.independent:
            words += f" Its residuals are {best.tests.words}."
        return words

    def _untold(self) -> str:
        """Return why no model is to be used."""
        best, moved, output = self.best, self.manipulated.name, self.output.name
        if not any(model.validated >= USEFUL for model in self.models):
            return f"on the held-back third the best, {best.name}, is hardly better than a constant"
        words = f"the record does not tell what {moved} does to {output}"
        if any(model.doubt == OUTWEIGHED for model in self.models):
            return f"{words}, as {OUTWEIGHED}"
        return f"{words}; what {output} does by itself explains as much"

    @property
    def gives_settings(self) -> bool:
        """Whether control settings follow from these models."""
        return self.for_control is not None and self.for_control.settings is not None

    @property
    def control_words(self) -> str:
        """The control settings that follow, in words."""
        model = self.for_control
        if model is None or model.settings is None:
            return "No control settings follow from these models."
        found, tightest = model.settings, model.settings.tightest
        late = time_text(found.delay)
        words = f"SIMC on {model.name}: {found.words}, "
        if tightest is None:
            words += f"for a closed-loop time constant of {late}, dead time and half a sample"
        else:
            words += (
                f"for a closed-loop time constant of {time_text(found.closed_loop_time_constant)}: "
                f"a setpoint step over all that {self.output.name} moved in the record then asks "
                f"{self.manipulated.name} for no more than it moved there. The tightest that SIMC "
                f"advises, {late}, is {tightest.words}"
            )
        words += f". The controller is sampled as the record, each {time_text(self.record.period)}."
        against = [*model.remarks, *([] if model.tests.independent else [_FAILS])]
        if against:
            words += f" Take them with care: {against[0]}."
        return words

    def as_dict(self) -> dict[str, Any]:
        """Return all of it, for JSON, in SI."""
        model = self.for_control
        return {
            "record": self.record.place,
            "manipulated": self.manipulated.name,
            "measured": self.output.name,
            "samples": self.record.samples,
            "sampling_period": self.record.period,
            "held_back_from": float(self.record.time[self.record.held_back]),
            "verdict": self.verdict,
            "control": self.control_words,
            "use": None if self.best.doubt else self.best.name,
            "use_for_control": None if model is None else model.name,
            "models": [model.as_dict() for model in self.models],
            "refused": [{"name": name, "reason": reason} for name, reason in self.refused],
            "warnings": list(self.warnings),
            "rule": RANKING_RULE,
        }


def identify_model(
    record: Record, manipulated: str | None = None, measured: str | None = None
) -> Identification:
    """Fit ARX, FOPDT, SOPDT and IPDT to a record, validate them and rank them.

    Parameters
    ----------
    record : Record
    manipulated, measured : str, optional
        Input and output. Where left out, the record has two columns, the input first, or one that
        moves in steps and one other that moves; a state that a sensor shows, as a simulation
        writes it, does not count.

    Raises
    ------
    InputError
        A name is unknown or missing, input and output are one, a signal stands still, or no
        model can be fitted.

    Examples
    --------
    >>> from clepsydra.identification.output_error import held_response
    >>> u = 3.0 + np.tile(np.repeat([0.0, 1.0, -1.0], 20), 4)
    >>> since = np.maximum(np.arange(240.0) - 3.4, 0.0)
    >>> level = 0.12 + held_response(u, 0.04 * (1.0 - np.exp(-since / 15.0)))
    >>> level += 1e-4 * np.random.default_rng(1).standard_normal(240)
    >>> signals = Signal("pump", "V"), Signal("level", "m", display_unit="cm")
    >>> found = identify_model(Record("by hand", signals, {"pump": u, "level": level}, 1.0))
    >>> found.best.name, [round(each.value, 2) for each in found.best.estimates]
    ('FOPDT', [0.04, 14.99, 3.4])
    """
    moved, output = _chosen(record, manipulated, measured)
    record.moving(moved.name)
    record.moving(output.name)
    models: list[FittedModel] = []
    refused = []
    for structure in (*STRUCTURES, None):
        try:
            if structure is None:
                models.append(arx_model(record, moved.name, output.name))
            else:
                models.append(transfer_model(structure, record, moved.name, output.name))
        except InputError as error:
            name = "ARX" if structure is None else structure.name
            refused.append((name, f"it takes {error.expected}; {error.remedy}"))
    if not models:
        raise InputError(
            record.place, f"{record.samples} rows", "a record that a model can be fitted to",
            refused[0][1],
        )  # fmt: skip
    return Identification(
        record=record,
        manipulated=moved,
        output=output,
        models=ranked(models),
        refused=tuple(refused),
        warnings=_warnings(record, moved, output),
    )


def _chosen(record: Record, manipulated: str | None, measured: str | None) -> tuple[Signal, Signal]:
    """Return input and output; what is not named is chosen where the record leaves one choice."""
    names = [signal.name for signal in record.signals]
    if manipulated is None and measured is None and len(names) == 2:
        manipulated, measured = names
    moving = _moving(record)
    in_steps = [n for n in moving if n != measured and _moves_in_steps(record.values[n])]
    if manipulated is None and len(in_steps) == 1:
        manipulated = in_steps[0]
    others = [name for name in moving if name not in (manipulated, *in_steps)]
    if measured is None and manipulated is not None and len(others) == 1:
        measured = others[0]
    if manipulated is None or measured is None:
        asked = [("manipulated", manipulated, in_steps), ("measured", measured, others)]
        missing = [option for option, given, _ in asked if given is None]
        example = [f'{option}="{given or (found or names)[0]}"' for option, given, found in asked]
        choice = [
            f"{option} may be {', '.join(found or names)[:120]}"
            for option, given, found in asked
            if given is None
        ]
        raise InputError(
            record.place, f"{len(names)} columns",
            f"to be told which of them is {' and which '.join(missing)}",
            f"name it, as in {', '.join(example)} ({'; '.join(choice)})",
        )  # fmt: skip
    moved = record.signal(manipulated, "manipulated")
    output = record.signal(measured, "measured")
    if moved == output:
        raise InputError(
            "measured", output.name, f"another column than the manipulated {moved.name}",
            "name what it moves",
        )  # fmt: skip
    return moved, output


def _moving(record: Record) -> list[str]:
    """Return the columns that move; a state that a sensor shows counts by its sensor."""
    shapes = {}
    for signal in record.signals:
        values = record.values[signal.name]
        if np.ptp(values) > _STILL * np.abs(values).max():
            shapes[signal.name] = (values - values[0]) / np.ptp(values)
    return [
        name
        for name, shape in shapes.items()
        if "." not in name
        or not any(
            "." not in other and np.allclose(shape, that, rtol=0.0, atol=_STILL)
            for other, that in shapes.items()
        )
    ]


def _warnings(record: Record, moved: Signal, measured: Signal) -> tuple[str, ...]:
    words = []
    count = record.held_back
    u = record.values[moved.name]
    if np.ptp(u[count:]) <= _STILL * np.ptp(u):
        words.append(
            f"{moved.name} does not move in the held-back third: what is validated there is where "
            f"{measured.name} comes to rest, not how it gets there"
        )
    others = [
        signal.name
        for signal in record.signals
        if signal.name not in (moved.name, measured.name)
        and _moves_in_steps(record.values[signal.name])
    ]
    if others:
        names = ", ".join(others[:6]) + (", …" if len(others) > 6 else "")
        words.append(
            f"{names} moved in steps as well: what that did to {measured.name} is in no model and "
            "counts as noise"
        )
    return tuple(words)


def _moves_in_steps(values: np.ndarray) -> bool:
    return 1 < len(np.unique(values)) <= _STEPS * len(values)


def _against(model: FittedModel, best: FittedModel) -> str:
    """Return why a model that fits better does not come first."""
    if model.doubt is not None:
        return f"but {model.doubt}"
    if not model.tests.independent:
        return f"but {_FAILS}"
    if not model.is_told:
        return f"but {model.remarks[0]}"
    if model.sign * best.sign < 0:
        return "but its gain has the other sign"
    return (
        "with more parameters" if model.parameters > best.parameters else "but coloured residuals"
    )
