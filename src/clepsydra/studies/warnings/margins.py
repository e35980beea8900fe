"""Warnings of a loop whose margins are too small."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from clepsydra.base.remark import Remark
from clepsydra.designs.slowing_down import SENSITIVITY_LIMIT
from clepsydra.linear.disk_margin import DiskMargin, structured_singular_values
from clepsydra.studies.warnings.channel import Channel
from clepsydra.studies.warnings.loop_response import LoopResponse

#: What the ranking calls robust: the limit of the designs, and what six digits of a gain leave
#: open of a design that ends there.
LARGEST_PEAK = SENSITIVITY_LIMIT * (1.0 + 3e-5)
_GAIN = 2.0
_PHASE = math.radians(30.0)
#: A peak of 2 leaves 2 asin(1/4) = 29°, which is no second warning.
_PHASE_AT_PEAK = 2.0 * math.asin(0.25)
#: Gain and phase that all channels withstand together: 1.5 and 22.6°.
_DISK = 0.4
#: Two channels whose margins differ by less are one loop, seen from its two ends.
_SAME = 1e-3


def margin_warnings(response: LoopResponse) -> Iterator[Remark]:
    """Return warnings of thin margins of the exact sampled loop.

    *Peak.* max|S| at the controlled measurements above 2, the largest singular value; and that
    of an inner loop of a cascade, at its measurement.

    *Channels.* A gain margin below 2, up or down, or a phase margin below 30°, with one
    measurement (also of an inner loop) or one manipulated variable broken at a time and the
    others closed. A loop whose peak of 2 leaves it 29° is let pass.

    *All at once.* The multiloop disk margin below 0.4, at the measurements or at the
    manipulated variables: every channel may change its gain by no more than a factor of 1.5, or
    its phase by 22.6°, if all do so independently and at once. It finds what no channel by
    itself shows, so it is said only where no channel has been named.

    An unstable loop has no margins: it raises none of these, but that of `stability`.

    References
    ----------
    S. Skogestad and I. Postlethwaite, Multivariable Feedback Control, 2nd ed., 2005, section
    2.4.3. P. Seiler, A. Packard and P. Gahinet, doi 10.1109/MCS.2020.3005277.
    """
    if not response.loop.is_stable:
        return
    peak = response.loop.maximum_sensitivity
    if peak > LARGEST_PEAK:
        sizes = np.linalg.norm(response.at_output, 2, axis=(1, 2))
        omega = response.frequencies[int(np.argmax(sizes))]
        yield Remark(
            f"max|S| is {peak:.2f} at {omega:.3g} rad/s, above 2",
            "a disturbance there is amplified as much, and a small error of the model makes "
            "the loop unstable",
            "lower the gains",
        )
    for name, values in response.at_inner.items():
        place = int(np.argmax(np.abs(values)))
        peak_there = float(np.abs(values[place]))
        if peak_there > LARGEST_PEAK:
            yield Remark(
                f"max|S| of the inner loop of {name} is {peak_there:.2f} at "
                f"{response.frequencies[place]:.3g} rad/s, above 2",
                "a disturbance there is amplified as much",
                "lower its gain",
            )
    named: list[Channel] = []
    for name, channel in response.channels.items():
        if any(_alike(channel, other) for other in named):
            continue
        said = _channel(channel, peak)
        if said:
            named.append(channel)
            others = " while the other loops are closed" if len(response.inputs) > 1 else ""
            yield Remark(
                f"The loop of {name} has {said}{others}",
                "an error of its model by as much makes it unstable",
                "make it slower",
            )
    if not named:
        yield from _all_at_once(response)


def _channel(channel: Channel, peak: float) -> str:
    said = []
    gain, phase = channel.gain_margin, channel.phase_margin
    factor = max(gain.value, 1.0 / gain.value)
    if factor < _GAIN * (1.0 - 1e-3):
        what = "a gain margin" if gain.value > 1.0 else "a margin against a falling gain"
        said.append(f"{what} of {factor:.2f} at {gain.frequency:.3g} rad/s (2 is wanted)")
    least = _PHASE if peak > LARGEST_PEAK else _PHASE_AT_PEAK * (1.0 - 1e-3)
    if phase.value < least:
        said.append(
            f"a phase margin of {math.degrees(phase.value):.0f}° at {phase.frequency:.3g} rad/s "
            "(30° is wanted)"
        )
    return " and ".join(said)


def _all_at_once(response: LoopResponse) -> Iterator[Remark]:
    for where, values in (
        ("measurements", response.at_output),
        ("manipulated variables", response.at_input),
    ):
        sizes = structured_singular_values(values - np.eye(values.shape[1]) / 2.0)
        place = int(np.argmax(sizes))
        disk = DiskMargin(min(1.0 / float(sizes[place]), 2.0), float(response.frequencies[place]))
        if disk.size < _DISK:
            yield Remark(
                f"If the gains of all {where} are wrong at once, by a factor of "
                f"{disk.gain:.2f} or by {math.degrees(disk.phase):.0f}° in different "
                f"directions, the loop becomes unstable at {disk.frequency:.3g} rad/s, though "
                "each alone may be wrong by more",
                remedy="use less decoupling or lower gains",
            )
            return


def _alike(channel: Channel, other: Channel) -> bool:
    return all(
        math.isclose(a.value, b.value, rel_tol=_SAME)
        for a, b in (
            (channel.gain_margin, other.gain_margin),
            (channel.phase_margin, other.phase_margin),
        )
    )
