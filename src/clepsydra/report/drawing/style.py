"""Colours and letters of drawings, on a light page and on a dark one."""

from __future__ import annotations

from clepsydra.report.colours import INK, MUTED

PAPER, DARK_PAPER = "#ffffff", "#14181d"
#: Bodies of plant equipment, pipes, frames of boxes.
STEEL, PIPE, FRAME = "#e9edf1", "#6e7781", "#7d868f"
#: What is abnormal.
ALARM = "#9c3708"
#: Liquid, and what is dissolved in it: one tint a component, in the order of the file.
TINTS = ("#d3e2ee", "#eadcc0", "#d5e6cf", "#e4d6e9", "#f1d5cb", "#cfe6e4")
#: Each colour in the dark.
_DARK = {
    PAPER: DARK_PAPER,
    INK: "#e6edf3",
    MUTED: "#9aa7b4",
    STEEL: "#2a313a",
    PIPE: "#8b949e",
    FRAME: "#7d868f",
    ALARM: "#ffa06b",
    **dict(
        zip(TINTS, ("#1c3a52", "#4b3d1c", "#274128", "#41304a", "#56301f", "#1a4340"), strict=True)
    ),
}
FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'Liberation Sans','DejaVu Sans',sans-serif"


def colour_style(scope: str) -> str:
    """Return the rules by which the drawings of a class turn dark on a dark page.

    A picture of its own follows the reader's system, one in a page the page. Where a viewer knows
    no such rules, the colours stay those of a light page, and they have paper of their own.

    Examples
    --------
    >>> '[fill="#ffffff"]{fill:light-dark(#ffffff,#14181d)}' in colour_style("plant")
    True
    """
    rules = [f"svg.{scope}:root{{color-scheme:light dark}}"]
    for light, dark in _DARK.items():
        for what in ("fill", "stroke"):
            rules.append(f'.{scope} [{what}="{light}"]{{{what}:light-dark({light},{dark})}}')
    return "".join(rules)
