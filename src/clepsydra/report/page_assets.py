"""The script and the style of the interactive report, where the installation has them."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources

#: What a report says where it has no script.
STILL_WORDS = (
    "The pictures of this report are still: when Clepsydra was installed from its sources, what"
    " makes them interactive could not be built. Install it once more with a network, or a wheel."
)


@dataclass(frozen=True)
class PageAssets:
    """What is put into a report to make its pictures interactive.

    Parameters
    ----------
    script, style : str
        JavaScript and CSS, whole: they fetch nothing.

    Examples
    --------
    >>> PageAssets("drawTrends();", ".interactive { margin: 0 }").script
    'drawTrends();'
    """

    script: str
    style: str


def page_assets() -> PageAssets | None:
    """Return script and style as the installation built them, or None where it could not.

    They are built from `page/`, which needs Node and its packages once, when Clepsydra is
    installed from its sources; a wheel has them. Without them pictures are still.

    Examples
    --------
    >>> assets = page_assets()
    >>> assets is None or "uPlot" in assets.script
    True
    """
    folder = resources.files("clepsydra.report") / "page"
    try:
        script = (folder / "report.js").read_text("utf-8")
        return PageAssets(script, (folder / "report.css").read_text("utf-8"))
    except FileNotFoundError:
        return None
