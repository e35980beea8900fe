"""A figure of a document, as data to be drawn again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

CurveKind = Literal["line", "held", "dashed", "points"]


@dataclass(frozen=True)
class Curve:
    """One line or cloud of points.

    Parameters
    ----------
    label : str
        What it shows; curves of one label have one colour in the whole figure. Empty for a line
        that needs no name.
    x, y : array [n]
    kind : {"line", "held", "dashed", "points"}
        "held" goes on level to the next point, as a sampled output does.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    kind: CurveKind = "line"

    def __post_init__(self) -> None:
        x, y = np.asarray(self.x, dtype=float).ravel(), np.asarray(self.y, dtype=float).ravel()
        if x.shape != y.shape:
            raise ValueError(f"curve {self.label!r} has {x.size} places and {y.size} values")
        object.__setattr__(self, "x", x)
        object.__setattr__(self, "y", y)


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Parameters
    ----------
    title : str
    y_label : str
        With its unit in brackets.
    curves : tuple of Curve
    x_label : str
    logarithmic_x, logarithmic_y : bool
        Values that are not positive are left out there.
    """

    title: str
    y_label: str
    curves: Sequence[Curve]
    x_label: str = "time [s]"
    logarithmic_x: bool = False
    logarithmic_y: bool = False


def curves(x: np.ndarray, values: Mapping[str, ArrayLike], kind: CurveKind = "line") -> list[Curve]:
    """Return curves over the same places by name."""
    return [Curve(name, x, np.asarray(y), kind) for name, y in values.items()]


def bode_panels(
    frequencies: np.ndarray, responses: Mapping[str, np.ndarray]
) -> tuple[Panel, Panel]:
    """Return magnitude and phase of frequency responses by name, over frequencies [rad/s]."""
    sizes = {name: 20.0 * np.log10(np.abs(values)) for name, values in responses.items()}
    phases = {k: np.degrees(np.unwrap(np.angle(values))) for k, values in responses.items()}
    over = "frequency [rad/s]", True
    return (
        Panel("magnitude", "magnitude [dB]", curves(frequencies, sizes), *over),
        Panel("phase", "phase [°]", curves(frequencies, phases), *over),
    )


@dataclass(frozen=True)
class Figure:
    """A figure, redrawn.

    Parameters
    ----------
    number : str
        As the document numbers it: "Fig. 7"; empty for one that it does not have.
    title : str
    panels : tuple of Panel
    note : str
        What the reader should see in it.
    """

    number: str
    title: str
    panels: Sequence[Panel]
    note: str = ""
