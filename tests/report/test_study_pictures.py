"""Loop, map and tuning pictures of a report: what stands where."""

import re
from dataclasses import replace

import numpy as np
import pytest

from clepsydra.report.loop_picture import loop_svg
from clepsydra.report.map_picture import map_svg
from clepsydra.report.tuning_picture import tuning_svg
from clepsydra.studies.result import Standing


def circles(text):
    found = re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)" r="([\d.]+)" fill="([^"]*)"', text)
    return [(float(x), float(y), float(r), fill) for x, y, r, fill in found]


def test_a_crossover_stands_on_the_unit_circle(result):
    candidate = result.ranking[0]
    disc, *dots = circles(loop_svg(candidate.response, result.process, "loops", "a"))
    # 3.8 units of the plane are 190 pt wide; the disc is around -1 with the radius 1/2.
    assert disc[2] == pytest.approx(0.5 * 190 / 3.8)
    origin = (disc[0] + 50.0, disc[1])
    assert len(dots) == 2
    for name, (x, y, _, _) in zip(candidate.response.outputs, dots, strict=True):
        real, imaginary = (x - origin[0]) / 50.0, (origin[1] - y) / 50.0
        assert np.hypot(real, imaginary) == pytest.approx(1.0, abs=0.01), name
        margin, _ = candidate.response.channels[name].phase_margin
        assert np.angle(-complex(real, imaginary)) == pytest.approx(margin, abs=0.02), name


def test_both_axes_of_the_plane_have_one_scale(result):
    text = loop_svg(result.ranking[0].response, result.process, "loops", "a")
    ticks = re.findall(r'<text x="([\d.]+)" y="213.5" text-anchor="middle">([−\d]+)<', text)
    (x1, v1), (x2, v2) = [(float(x), int(v.replace("−", "-"))) for x, v in ticks[:2]]
    ticks = re.findall(r'<text x="40.5" y="([\d.]+)" text-anchor="end">([−\d]+)<', text)
    (y1, w1), (y2, w2) = [(float(y), int(v.replace("−", "-"))) for y, v in ticks[:2]]
    assert (x2 - x1) / (v2 - v1) == pytest.approx((y1 - y2) / (w2 - w1), abs=0.2)


def ranked(result, peaks, errors, standings=None):
    standings = standings or [Standing.ROBUST] * len(peaks)
    candidates = [
        replace(result.ranking[0], rank=n, maximum_sensitivity=p, relative_error=e, standing=s)
        for n, (p, e, s) in enumerate(zip(peaks, errors, standings, strict=True), start=1)
    ]
    return replace(result, ranking=tuple(candidates))


def places(text):
    """Rank to the place of its number."""
    found = re.findall(
        r'<text x="([\d.]+)" y="([\d.]+)" text-anchor="middle"[^>]*>(\d+)</text>', text
    )
    return {int(rank): (float(x), float(y)) for x, y, rank in found if float(y) < 158.0}


def test_robust_is_left_and_good_is_low(result):
    shown = places(map_svg(ranked(result, [1.2, 1.8, 1.5], [1.0, 3.0, 2.0]), "map", "a"))
    assert shown[1][0] < shown[3][0] < shown[2][0]
    assert shown[1][1] > shown[3][1] > shown[2][1]


def test_ranks_cover_each_other_nowhere(result):
    shown = places(map_svg(ranked(result, [1.4] * 18, [2.0] * 18), "map", "a"))
    assert len(shown) == 18
    points = np.array(list(shown.values()))
    distances = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    assert np.min(distances + 1e9 * np.eye(18)) > 12.0


def test_points_stand_where_their_numbers_are_however_close_they_are(result):
    """Two that differ by a thousandth are drawn a thousandth apart, and so are 18 at one place."""
    peaks = [1.4, 1.4014, 1.9, *[1.6] * 18]
    errors = [2.0, 2.0, 3.998, *[4.0] * 18]
    text = map_svg(ranked(result, peaks, errors), "map", "a")
    points = [(x, y) for x, y, *_ in circles(text)][: len(peaks)]
    left, right = points[0][0], points[2][0]
    for peak, error, (x, y) in zip(peaks, errors, points, strict=True):
        share = np.log(peak / 1.4) / np.log(1.9 / 1.4)
        assert x == pytest.approx(left + share * (right - left), abs=0.11)
        share = np.log(error / 2.0) / np.log(2.0)
        assert y == pytest.approx(points[0][1] + share * (points[3][1] - points[0][1]), abs=0.11)
    assert len(places(text)) == len(peaks)


def test_what_is_out_of_the_question_stands_at_the_edge(result):
    text = map_svg(
        ranked(
            result, [1.2, np.inf, 1.4], [1.0, 2.0, np.inf],
            [Standing.ROBUST, Standing.UNSAFE, Standing.NERVOUS],
        ), "map", "a",
    )  # fmt: skip
    assert len(places(text)) == 3 and "nan" not in text and "inf" not in text
    for words in ("unsafe", "robust, nervous", "robust and quiet"):
        assert f">{words}<" in text


def test_what_has_no_margins_is_left_out(result):
    text = map_svg(ranked(result, [1.2, np.nan, 1.4], [1.0, 2.0, 3.0]), "map", "a")
    assert sorted(places(text)) == [1, 3] and "nan" not in text


def test_one_controller_needs_no_map(result):
    assert map_svg(ranked(result, [1.2], [1.0]), "map", "a") == ""


def test_the_front_falls_and_ends_at_the_chosen_point(result):
    tuning = result.ranking[0].tuning
    text = tuning_svg(tuning, "front", "a")
    *front, start, chosen = circles(text)
    assert len(front) == 3
    xs, ys = [x for x, *_ in front], [y for _, y, *_ in front]
    assert xs == sorted(xs) and ys == sorted(ys)  # down the page is a smaller objective
    assert chosen[:2] == front[-1][:2]
    # The objective at the start, 1, is as far above 0.9 as half of 0.7 to 0.9.
    assert ys[0] - start[1] == pytest.approx((ys[1] - ys[0]) / 2, abs=0.2)


def test_a_front_of_many_times_has_a_logarithmic_scale(result):
    tuning = result.ranking[0].tuning
    front = replace(tuning.front, objective=np.array([10.0, 1.0, 0.1]))
    text = tuning_svg(replace(tuning, front=front, objective=0.1), "front", "a")
    ys = [y for _, y, *_ in circles(text)[:3]]
    assert ys[1] - ys[0] == pytest.approx(ys[2] - ys[1], abs=0.2)
