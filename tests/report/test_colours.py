from itertools import combinations

import numpy as np

from clepsydra.report.colours import INK, MUTED, PALETTE, signal_colours

# Linear RGB as people without red or without green cones see it: Viénot, Brettel and Mollon,
# Color Research and Application 24(4), 1999, 243-252.
DICHROMATS = {
    "protanope": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deuteranope": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}


def linear(colour):
    channels = np.array([int(colour[place : place + 2], 16) for place in (1, 3, 5)]) / 255
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


def contrast_to_white(colour):
    return 1.05 / (linear(colour) @ [0.2126, 0.7152, 0.0722] + 0.05)


def lightness_and_hue(rgb):
    """CIE L*a*b* under D65."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    white = to_xyz @ np.ones(3)
    scaled = np.cbrt(np.maximum(to_xyz @ rgb / white, 1e-4))
    return np.array(
        [116 * scaled[1] - 16, 500 * (scaled[0] - scaled[1]), 200 * (scaled[1] - scaled[2])]
    )


def test_text_is_dark_and_lines_are_visible_on_white():
    assert min(contrast_to_white(colour) for colour in (INK, MUTED)) > 4.5
    assert min(contrast_to_white(colour) for colour in PALETTE) > 2.0


def test_the_colours_of_four_tanks_stay_apart_for_colour_blind_readers():
    for name, matrix in DICHROMATS.items():
        seen = [lightness_and_hue(np.array(matrix) @ linear(colour)) for colour in PALETTE[:8]]
        # A difference of about 2.3 is just noticeable side by side.
        assert min(np.linalg.norm(a - b) for a, b in combinations(seen, 2)) > 9.0, name


def test_a_measurement_has_the_colour_of_its_level_and_no_two_other_signals_share_one(process):
    colours = signal_colours(process)
    own = [*process.state, *process.inputs, *process.disturbances]
    assert len({colours[signal.name] for signal in own}) == len(own)
    assert all(colours[name] == colours[level] for name, level in process.measured_state.items())
