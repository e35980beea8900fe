"""What a cell of Table 6 leaves out: its constants, the step, and the limits of both inputs."""

from __future__ import annotations

from clepsydra.papers.averaging_tank.continuous_pi import Constants, continuous_run


def other_limits(best: Constants, index: str, output: str) -> str:
    """Say what is not printed, and what a cell is within other limits, under IE's constants."""
    place, flow = ("(81)", "f_in") if best.constant == "outflow" else ("(83)", "f_out")
    step = "0.25 kmol/m³" if output == "C" else "0.1 m³"
    found = continuous_run(best, free=True).indices[index, output]
    freed = continuous_run(best, free=True, free_flow=True).indices[index, output]
    words = [f"{flow} limited to 0 to 1 m³/s, the range of section 3.3,"]
    if output == "C":
        limited = continuous_run(best).indices[index, output]
        words.append(f"and C_in free; with C_in within 0 to 25 kmol/m³ too it is {limited:.3g},")
    same = f"{found:.3g}" == f"{freed:.3g}"
    words.append("and with no limits it is " + ("the same." if same else f"{freed:.3g}."))
    if best.constant == "outflow" and index == "ITAE":
        words.append(
            "C and V print one number here, as constants do that make the larger of both smallest."
        )
    return (
        "Which constants this row of Table 6 has is not said: those printed for PI, "
        f"{place}, are optimal by IE. With them, a step of {step} as follows from Table 7, and "
        f"20 s, it is this with {' '.join(words)}"
    )
