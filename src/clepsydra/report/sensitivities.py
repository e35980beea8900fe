"""The largest singular value of S over frequency, of each controller: numbers to draw."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from clepsydra.studies.result import Candidate
from clepsydra.studies.warnings.loop_response import LoopResponse

#: Frequencies to the decade, and decades below the highest frequency.
_PER_DECADE, _DECADES = 40, 4.0


def sensitivity_data(ranking: Sequence[Candidate]) -> dict[str, Any] | None:
    """Return frequencies [rad/s] and each controller's S at the measurements; None without any.

    Returns
    -------
    dict or None
        "frequencies", and in "curves" a list for each controller with null where its loop has no
        such frequency, or null for one without a linear loop.

    Examples
    --------
    >>> import clepsydra as cl
    >>> plant = cl.load("three-tanks")
    >>> result = cl.study(plant, [cl.design.simc(plant)])
    >>> data = sensitivity_data(result.ranking)
    >>> len(data["frequencies"]), max(data["curves"][0]) <= result.best.maximum_sensitivity
    (161, True)
    """
    responses = [each.response for each in ranking]
    ends = [float(each.frequencies[-1]) for each in responses if each is not None]
    if not ends:
        return None
    highest = np.log10(max(ends))
    grid = np.logspace(highest - _DECADES, highest, round(_DECADES * _PER_DECADE) + 1)
    return {
        "frequencies": [float(f"{each:.4g}") for each in grid],
        "curves": [None if each is None else _curve(each, grid) for each in responses],
    }


def _curve(response: LoopResponse, grid: np.ndarray) -> list[float | None]:
    sizes = np.linalg.svd(response.at_output, compute_uv=False)[:, 0]
    known = np.isfinite(sizes)
    found = np.interp(
        np.log(grid), np.log(response.frequencies[known]), sizes[known], left=np.nan, right=np.nan
    )
    return [float(f"{each:.3g}") if np.isfinite(each) else None for each in found]
