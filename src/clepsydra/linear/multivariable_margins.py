"""Margins of several loops together, at the plant input and at its output."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clepsydra.base.errors import InputError
from clepsydra.linear.disk_margin import DiskMargin, disk_margin
from clepsydra.linear.frequency_grid import frequency_grid
from clepsydra.linear.frequency_peak import SensitivityPeak
from clepsydra.linear.interconnection import feedback, parallel_channels, series
from clepsydra.linear.linear_model import LinearModel
from clepsydra.linear.loop_margins import LoopMargins, loop_margins, sensitivity_peaks
from clepsydra.linear.stability import asymptotically_stable


@dataclass(frozen=True)
class MarginsAt:
    """The margins where the loops are broken: all at the plant output, or all at its input.

    Parameters
    ----------
    sensitivity, complementary : SensitivityPeak
        Largest singular values of S and of T over frequency; infinite for an unstable loop.
        They depend on the units of the signals unless the model has these as shares of their
        ranges.
    disk : DiskMargin
        Every channel changed independently and at once.
    loops : dict of str to LoopMargins
        One channel at a time, by its signal, while the others stay closed.

    Examples
    --------
    >>> peak = SensitivityPeak(1.5, 0.1)
    >>> MarginsAt(peak, peak, DiskMargin(1.0, 0.1), {}).disk.gain
    3.0
    """

    sensitivity: SensitivityPeak
    complementary: SensitivityPeak
    disk: DiskMargin
    loops: dict[str, LoopMargins]


@dataclass(frozen=True)
class MultivariableMargins:
    """The margins of a plant under a controller.

    Parameters
    ----------
    stable : bool
        Of the closed loop, with every state of plant and controller. Where it is not, there are
        no margins: the peaks are infinite and the disks have size zero.
    at_output, at_input : MarginsAt
        S = (I + G K)⁻¹ and S = (I + K G)⁻¹.
    disk : DiskMargin
        Every plant input and output changed independently and at once.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> gain = LinearModel(np.zeros((0, 0)), np.zeros((0, 1)), np.zeros((0, 0)),
    ...                    np.zeros((1, 0)), 2.0 * one, (), ("error",), (), ("pump",))
    >>> multivariable_margins(tank, gain).at_output.complementary.peak.__round__(9)
    0.8
    """

    stable: bool
    at_output: MarginsAt
    at_input: MarginsAt
    disk: DiskMargin


def multivariable_margins(plant: LinearModel, controller: LinearModel) -> MultivariableMargins:
    """Return the margins of a plant G under a controller K, exact with dead time.

    Parameters
    ----------
    plant : LinearModel
        G, from the manipulated inputs to the controlled outputs.
    controller : LinearModel
        K, from the control errors setpoint - output, in the order of the plant's outputs, to
        the manipulated inputs, in the order of the plant's inputs.

    Raises
    ------
    InputError
        The numbers of signals do not fit, two signals of the plant have one name, the loop is
        not well posed, or its stability cannot be decided.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, chapters
    3 and 9. The disk margins: doi 10.1109/MCS.2020.3005277.

    Examples
    --------
    See `MultivariableMargins`.
    """
    if len(controller.outputs) != len(plant.inputs):
        raise InputError(
            "controller, outputs",
            f"{len(controller.outputs)} ({', '.join(controller.outputs)})",
            f"{len(plant.inputs)}, one for each of {', '.join(plant.inputs)}",
            "give a controller with an output for every input of the plant",
        )
    for names in (plant.inputs, plant.outputs):
        if len(set(names)) < len(names):
            raise InputError(
                "plant, signals",
                ", ".join(names),
                "each name once",
                "name the signals of the plant apart, by dataclasses.replace",
            )
    at_output, at_input = loop_at_output(plant, controller), loop_at_input(plant, controller)
    return MultivariableMargins(
        stable=asymptotically_stable(feedback(at_output)),
        at_output=_margins(at_output),
        at_input=_margins(at_input),
        disk=disk_margin(_loop_at_both(plant, controller)),
    )


def loop_at_output(plant: LinearModel, controller: LinearModel) -> LinearModel:
    """Return L = G K, broken at the plant output; its channels have the names of the outputs.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> loop_at_output(tank, tank).outputs
    ('level',)
    """
    return series(controller, plant)


def loop_at_input(plant: LinearModel, controller: LinearModel) -> LinearModel:
    """Return L = K G, broken at the plant input; its channels have the names of the inputs.

    Examples
    --------
    >>> one = np.eye(1)
    >>> tank = LinearModel(-0.02 * one, 0.04 * one, one[:, :0], one, 0.0 * one,
    ...                    ("tank.level",), ("pump",), (), ("level",))
    >>> loop_at_input(tank, tank).outputs
    ('pump',)
    """
    return replace(series(plant, controller), outputs=plant.inputs)


def _loop_at_both(plant: LinearModel, controller: LinearModel) -> LinearModel:
    """Return [[0, K], [-G, 0]], whose channels are the plant inputs and then its outputs.

    Closed by negative unity feedback its errors obey u = -K y and y = G u, the loop itself.
    """
    q = len(plant.outputs)
    joined = parallel_channels(controller, plant)  # inputs y, u; outputs u, y
    at, matrix = joined.ports, joined.matrix
    matrix[:, at.u] = np.roll(matrix[:, at.u], -q, axis=1)
    matrix[at.y][len(plant.inputs) :] *= -1.0
    inputs = joined.inputs[q:] + joined.inputs[:q]
    return joined.with_matrix(matrix, joined.times, inputs=inputs)


def _margins(loop: LinearModel) -> MarginsAt:
    closed = feedback(loop)
    grid, stable = frequency_grid(loop, closed), asymptotically_stable(closed)
    sensitivity, complementary = sensitivity_peaks(closed, grid, stable)
    return MarginsAt(
        sensitivity=sensitivity,
        complementary=complementary,
        disk=disk_margin(loop),
        loops={
            name: loop_margins(_one_channel(loop, channel))
            for channel, name in enumerate(loop.outputs)
        },
    )


def _one_channel(loop: LinearModel, channel: int) -> LinearModel:
    """Return the loop as it is seen where one channel is broken and the others are closed."""
    others = [other for other in range(len(loop.outputs)) if other != channel]
    numbers = tuple(str(number) for number in range(len(loop.outputs)))
    broken = replace(feedback(loop, others), inputs=numbers, outputs=numbers)
    return broken.select(outputs=[str(channel)], inputs=[str(channel)])
