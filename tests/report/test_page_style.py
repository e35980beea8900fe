"""Colours of a page stand out from its paper, light and dark (WCAG 2.2, 1.4.3 and 1.4.11)."""

import re
from importlib import resources

import pytest

STYLE = resources.files("clepsydra.report").joinpath("page_style.css.jinja").read_text("utf-8")


def luminance(colour):
    digits = colour * 2 if len(colour) == 3 else colour
    shares = [int(digits[place : place + 2], 16) / 255 for place in (0, 2, 4)]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one, two):
    high, low = sorted((luminance(one), luminance(two)), reverse=True)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("place", [0, 1], ids=["light", "dark"])
def test_text_has_a_contrast_of_4_5_and_lines_have_3(place):
    blocks = re.findall(r":root[^{]*\{([^}]*--paper[^}]*)\}", STYLE)
    colours = dict(re.findall(r"--([a-z0-9-]+): #([0-9a-f]+)", blocks[place]))
    paper = colours["paper"]
    for name in ("ink", "muted", "link", "alarm", "bad"):
        assert contrast(colours[name], paper) >= 4.5, name
    curves = [name for name in colours if name.startswith("curve-")]
    assert len(curves) == 8
    for name in curves:
        assert contrast(colours[name], paper) >= 3.0, name
