"""Sections 3.1.3 and 4: what the document says of PI control, by hand and by its optimum."""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np

from clepsydra.papers.averaging_tank import PRINTED
from clepsydra.papers.averaging_tank.continuous_pi import (
    HIGHEST_INLET,
    Constants,
    ContinuousRun,
    continuous_run,
)
from clepsydra.papers.averaging_tank.lqi_runs import COLUMNS, lqi_run
from clepsydra.papers.averaging_tank.pi import BY_HAND, OPTIMAL
from clepsydra.papers.averaging_tank.printed_tables import (
    FUZZY_INDICES,
    KEYS,
    LQI_INDICES,
    PI_INDICES,
    lower_cells,
)
from clepsydra.papers.averaging_tank.step_run import STEPS, settling, settling_words
from clepsydra.papers.averaging_tank.symbols import C0, FLOW, V0, VARIANTS, Variant, constant_flow
from clepsydra.papers.document import Found
from clepsydra.papers.row import Row, Rows

#: Indices beside IE, of which none is another's bound.
_INDICES = ("IAE", "ISE", "ITAE")
#: An index that is larger by less is not told.
_MORE = 1.05


def run() -> Found:
    """Return the rows on what is said of PI control."""
    return (
        _stable_by_hand(), _what_ie_chooses(), _lowest_by_ie(), *_outflow_constant(),
        *_either_constant(), _against_others(),
    )  # fmt: skip


def _free(constants: Constants) -> ContinuousRun:
    """Return the document's step with C_in free, as Table 6 has it."""
    return continuous_run(constants, free=True)


def _stable_by_hand() -> Row:
    """Judge the constants by hand by the poles of (57) and (74)."""
    slowest = {}
    for variant, hand in BY_HAND.items():
        of_c = [hand.time_c * V0, hand.time_c * FLOW * (1.0 + hand.gain_c), FLOW * hand.gain_c]
        of_v = [hand.time_v, hand.time_v * hand.gain_v, hand.gain_v]
        poles = np.concatenate([np.roots(of_c), np.roots(of_v)])
        slowest[constant_flow(variant)] = float(poles.real.max())
    return PRINTED["section 3.1.3", "stability by hand"].claimed(
        max(slowest.values()) < 0.0,
        "rightmost poles at " + ", ".join(f"{at:.3g} 1/s ({flow})" for flow, at in slowest.items()),
    )


def _error_of(constants: Constants) -> float:
    """Return IE of C that follows from the constants alone [kmol s/m³]."""
    return constants.time_c / constants.gain_c * STEPS["C"]


def _what_ie_chooses() -> Row:
    pairs = [
        (_error_of(each._replace(time_c=each.time_c / 10.0)), _error_of(each))
        for each in OPTIMAL.values()
    ]
    told = " and ".join(f"{tenth:.1e} from {whole:.1e}" for tenth, whole in pairs)
    return PRINTED["section 3.1.3", "PI, what IE chooses"].claimed(
        any(tenth >= whole for tenth, whole in pairs), f"a tenth of T_iC makes IE of C {told}"
    )


def _lowest_by_ie() -> Row:
    """Compare the constants that are optimal by IE with those by hand and with Table 6."""
    told = []
    for variant, (index, output) in product(VARIANTS, product(_INDICES, STEPS)):
        ours = _free(OPTIMAL[variant]).indices[index, output]
        cell = f"{index} of {output}, {constant_flow(variant)}"
        others = {
            "by hand": _free(BY_HAND[variant]).indices[index, output],
            "in Table 6": PRINTED["Table 6", cell].value,
        }
        lower = ", ".join(
            f"{value:.3g} {where}" for where, value in others.items() if _MORE * value < ours
        )
        told += [f"{cell}: {ours:.3g} by IE against {lower}"] if lower else []
    hand, best = (_free(each["inflow"]) for each in (BY_HAND, OPTIMAL))
    overshoots = " and ".join(
        f"{o} by {best.overshoot(o):.0f} % against {hand.overshoot(o):.1f} % by hand" for o in STEPS
    )
    return PRINTED["section 4", "PI, lowest by IE"].remark(
        f"{'; '.join(told)}; with f_in constant the optimum overshoots in {overshoots}"
    )


def _outflow_constant() -> Rows:
    """Judge what is said of the system with constant outflow."""
    hand, free = continuous_run(BY_HAND["outflow"]), _free(OPTIMAL["outflow"])
    limited = continuous_run(OPTIMAL["outflow"])
    slope = FLOW / V0 * (HIGHEST_INLET - C0)
    yield PRINTED["section 4", "PI, settling and rise with f_out constant"].remark(
        "; ".join(_times(o, free, hand) for o in STEPS),
        least=STEPS["C"] ** 3 / (3.0 * slope),
        limited=limited.settling("C"),
    )
    yield PRINTED["section 4", "PI, wind-up with f_out constant"].remark(
        f"C_in within 0 to {HIGHEST_INLET:g} kmol/m³ stands at a limit for "
        f"{limited.at_limit('inlet'):.1f} s by (81), for {hand.at_limit('inlet'):.1f} s by (80)"
    )
    yield PRINTED["section 4", "PI, overshoot of V with f_out constant"].remark(
        f"{free.overshoot('V'):.1f} % by (81), {hand.overshoot('V'):.1f} % by (80)"
    )
    yield PRINTED["section 4", "PI, f_in with f_out constant"].remark(
        f"largest {float(free.flow.max()):.3f} m³/s, at the first instant"
    )


def _times(output: str, ours: ContinuousRun, by_hand: ContinuousRun) -> str:
    return (
        f"{output} settles, against by hand, in "
        f"{settling_words(output, ours.settling, by_hand.settling)}, and rises in "
        f"{ours.rise_time(output):.3f} s against {by_hand.rise_time(output):.3f} s"
    )


def _either_constant() -> Rows:
    """Judge what is said of constant inflow, and of C in Fig. 7a, which shows both systems."""
    runs: dict[Variant, tuple[ContinuousRun, ContinuousRun]] = {
        variant: (_free(OPTIMAL[variant]), _free(BY_HAND[variant])) for variant in VARIANTS
    }
    yield PRINTED["section 4", "PI, settling and rise of C"].remark(
        "; ".join(
            f"{constant_flow(variant)}: {_times('C', *found)}" for variant, found in runs.items()
        )
    )
    other, hand = runs["inflow"]
    yield PRINTED["section 4", "PI, f_out with f_in constant"].claimed(
        other.at_limit("flow") > 2.0 * hand.at_limit("flow"),
        f"{other.at_limit('flow'):.2f} s of the {other.settling('V'):.2f} s until V settles, "
        f"{hand.at_limit('flow'):.2f} s by hand",
    )


def _against_others() -> Row:
    others = {"LQI": LQI_INDICES, "fuzzy": FUZZY_INDICES}
    wins = [f"{cell} ({who})" for who in others for cell in lower_cells(PI_INDICES, others[who])]
    settled = [
        f"{tuned} {o} settles, against LQI, in "
        + settling_words(o, _free(constants).settling, partial(settling, lqi_run(column)))
        for tuned, constants, column in (
            ("optimal", OPTIMAL["outflow"], COLUMNS[1]), ("by hand", BY_HAND["outflow"], COLUMNS[0])
        )
        for o in STEPS
    ]  # fmt: skip
    worst = (
        f"{i} of {o}"
        for i, o in KEYS
        if all(PI_INDICES[i, o] > each[i, o] for each in others.values())
    )
    return PRINTED["section 4", "PI against the others"].remark(
        f"Table 6 is lower in {', '.join(wins)}; {'; '.join(settled)}", worst=", ".join(worst)
    )
