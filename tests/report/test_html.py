import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from clepsydra.process.reader import load_process
from clepsydra.report import html
from clepsydra.report.html import address_text, report_text
from clepsydra.report.page import STILL_WORDS
from clepsydra.studies.recommendation import Remark

VOID = {"meta", "br", "link", "img", "hr", "input"}
#: What makes the pictures of a report interactive.
ASSETS = ("script", "style", "worker")


class Reader(HTMLParser):
    """Collects tags, attributes and words, and checks that elements close in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.attributes, self.words = [], [], [], []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += attributes

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def text(result):
    return report_text(result)


@pytest.fixture(scope="module")
def reader(text):
    return Reader(text)


def test_nothing_is_loaded_from_anywhere(text, reader):
    assert not {"link", "img", "iframe", "object", "embed", "base"} & set(reader.tags)
    for name, value in reader.attributes:
        if name in ("src", "srcset", "href", "xlink:href", "action", "data", "poster"):
            assert value.startswith("#"), (name, value)
        if name.startswith("on"):
            raise AssertionError(name)
    assert all(target.startswith("#") for target in re.findall(r"url\(['\"]?([^)]*)\)", text))
    assert "@import" not in text
    addresses = set(re.findall(r"https?://[^\"' <>]+", text))
    assert addresses <= {"http://www.w3.org/2000/svg", "http://www.w3.org/1999/xlink"}
    policy = dict(reader.attributes)["content"]
    assert "default-src 'none'" in text and "http" not in policy


def test_elements_close_in_order_and_ids_are_unique(text, reader):
    assert reader.open == []
    ids = [value for name, value in reader.attributes if name == "id"]
    assert len(ids) == len(set(ids)) > 5
    wanted = {value[1:] for name, value in reader.attributes if name.endswith("href")}
    wanted |= set(re.findall(r"url\(#([^)]*)\)", text))
    assert wanted and wanted <= set(ids)


def test_the_first_screen_answers_in_the_order_of_the_questions(text):
    body = text[text.index("<main>") :]
    parts = (
        "<h1>Use PI, phase margin: it settles in 140 s",
        "<h2>Settings</h2>",
        "<h2>How good</h2>",
        "<h2>How sure</h2>",
        "<svg",
        'class="ranking"',
    )
    places = [body.index(part) for part in parts]
    assert places == sorted(places)


def test_what_is_told_on_request_is_folded_and_filled_when_it_is_opened(text):
    heads = [re.sub(r"<.*?>", "", head) for head in re.findall(r"<summary>(.*?)</summary>", text)]
    assert heads == [
        "1. PI, phase margin",
        "The blocks of its export",
        "2. PI, &lt;SIMC&gt; &amp; detuned",
        "What the linear model says",
        "Not applicable, and why",
        "What the numbers mean, and what decides the order",
        "How this was computed",
    ]
    assert text.count("</summary><template>") == len(heads)


def test_without_a_script_what_is_folded_is_there_from_the_start(result, monkeypatch):
    monkeypatch.setattr(html, "page_assets", lambda: None)
    page = report_text(result)
    assert "<template>" not in page and "<noscript>" not in page
    assert page.count("<details>") == 7


def test_the_data_of_the_pictures_are_the_runs(result, text):
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1))
    assert [each["title"] for each in data["events"]][:2] == ["Setpoint level_1 +2 cm"] + [
        "Setpoint level_1 −2 cm"
    ]
    names = [each["name"] for each in data["signals"]]
    assert names == ["level_1", "level_2", "pump_1", "pump_2"]
    drawn = ["tank_1.level", "tank_2.level", *names[2:]]
    for event, segment in zip(data["events"], result.scenario.segments, strict=True):
        places = np.cumsum(event["samples"]) + round(segment.start)
        for name, trace in zip(drawn, event["traces"], strict=True):
            factor = 100.0 if name.endswith("level") else 1.0  # [cm], [V]
            for candidate, coded in zip(result.ranking, trace["curves"], strict=True):
                shown = np.cumsum(coded) * trace["step"]
                run = factor * candidate.run.values[name][places]
                assert shown == pytest.approx(run, abs=0.51 * trace["step"])


def test_a_curve_between_the_points_that_are_drawn_is_near_to_all_samples(result, text):
    """All samples of the windows seen at first, to a hundredth of what the curve spans."""
    data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1))
    for event, segment in zip(data["events"], result.scenario.segments, strict=True):
        if segment.kind == "noise":
            continue
        start = round(segment.start)
        places = np.cumsum(event["samples"]) + start
        every = np.arange(places[0], start + round(event["view"][1]))
        for place, candidate in enumerate(result.ranking):
            level = 100.0 * candidate.run.values["tank_1.level"]
            trace = event["traces"][0]
            drawn = np.interp(every, places, np.cumsum(trace["curves"][place]) * trace["step"])
            assert np.max(np.abs(drawn - level[every])) < 0.01 * np.ptp(level[every])


def test_the_reader_finds_reasons_warnings_numbers_and_how_they_came_about(result, reader):
    words = " ".join(" ".join(reader.words).split())
    for candidate in result.ranking:
        assert candidate.reason in words
        assert candidate.controller.design in words
        assert all(warning in words for warning in candidate.warnings)
    assert "the process has no dead time" in words
    assert "error at most 3.2e-09 of the state's range" in words
    assert f"samples {result.scenario.samples}" in words
    assert "seed of the noise 7" in words
    assert "Python 3." in words


def test_words_of_a_user_are_never_markup(result):
    attack = '<script>alert("x")</script>'
    first = result.ranking[0]
    hostile = replace(
        result,
        process=replace(result.process, title=attack, source=attack),
        verdict=attack,
        ranking=(replace(first, reason=attack, warnings=(type(result.warnings[0])(attack),)),),
        not_applicable=((attack, attack),),
    )
    assert attack not in report_text(hostile)


@pytest.mark.parametrize(
    "assets",
    [None, {"script": "drawTrends()", "style": ".own { margin: 0 }", "worker": "runLoops()"}],
)
def test_pictures_are_interactive_where_the_installation_has_the_script(
    result, assets, monkeypatch
):
    monkeypatch.setattr(html, "page_assets", lambda: assets)
    reader = Reader(report_text(result))
    assert reader.open == []
    scripts = ["drawTrends()" in reader.words, "script" in reader.tags]
    assert scripts == [assets is not None] * 2
    assert (STILL_WORDS in reader.words) is (assets is None)


@pytest.mark.parametrize("moves", [True, False])
def test_only_a_page_whose_settings_move_may_run_modules_and_a_worker(result, monkeypatch, moves):
    monkeypatch.setattr(
        html, "page_assets", lambda: {**dict.fromkeys(ASSETS, ""), "worker": "go()"}
    )
    if not moves:
        monkeypatch.setattr(html, "live_data", lambda *_: None)
    reader = Reader(report_text(result))
    (policy,) = (value for _, value in reader.attributes if str(value).startswith("default-src"))
    more = " 'wasm-unsafe-eval'; worker-src blob:" if moves else ""
    expected = f"default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'{more}"
    assert policy == f"{expected}; img-src data:"
    assert ("go()" in reader.words) is moves


def test_a_second_report_is_equal_and_written_whole(result, text, tmp_path):
    path = tmp_path / "report.html"
    result.report(path)
    assert path.read_text("utf-8") == text
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_a_failure_leaves_the_old_report_and_nothing_else(result, tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("the old one")
    monkeypatch.setattr(html, "report_text", lambda _: "cut \ud800 off")  # cannot be encoded
    with pytest.raises(UnicodeEncodeError):
        result.report(path)
    assert path.read_text() == "the old one"
    assert [entry.name for entry in tmp_path.iterdir()] == ["report.html"]


def test_a_study_without_any_controller_still_says_why(result):
    words = " ".join(Reader(report_text(replace(result, ranking=()))).words)
    assert "Not applicable, and why" in words
    assert "the process has no dead time" in words


def words_of(text):
    return " ".join(" ".join(Reader(text).words).split())


def test_the_page_of_a_controller_says_all_that_a_loop_needs(text):
    whole = words_of(text)
    page = whole[whole.rindex("1. PI, phase margin") : whole.rindex("2. PI, <SIMC>")]
    for words in (
        "pump_2.out pump_2",
        "measures level_1 (0 to 10 V)",
        "setpoint from the operator, 6.131 V = 12.26 cm at rest",
        "ISA (standard, non-interacting): u = K (b r − y) + K/Ti ∫ e dt, e = r − y",
        "action reverse: the output rises when the measurement falls",
        "gain K 3.000 V/V, that is 3.000 %/%",
        "proportional band 33.33 %",
        "30.00 s = 0.5000 min/repeat = 2.000 repeats/min",
        "anti-windup back-calculation: the integral follows what was applied",
        "tracking time 30.00 s",
        "output limits 0 to 10.00 V",
        "output at rest 3.000 V",
        "Margins, the other loops closed",
        "IAE of level_1 50.0 V s 30.0 V s",
        "Status of pump_1",
    ):
        assert words in page, words
    assert "ISA form, every 1 s." in whole


def test_the_times_of_the_scenario_have_one_unit(text):
    """The steps lie within the first minutes of a run of more than an hour."""
    table = re.search(r"<caption>Scenario</caption>.*?</table>", text, re.DOTALL).group()
    assert "time [min]" in table
    times = re.findall(r"<td>([^<]*) – ([^<]*)</td>", table)
    assert len(times) > 2 and all(float(end) > float(start) for start, end in times)


def test_numbers_in_words_of_a_design_have_the_minus_of_the_tables(result):
    told = replace(
        result,
        warnings=(Remark("slope -0.5 %/% (-3 V), as in --input 'pump_1=-1 V'"),),
        not_applicable=(("PI-2, own", "its gain is -2 V/V"),),
    )
    words = words_of(report_text(told))
    assert "slope −0.5 %/% (−3 V), as in --input 'pump_1=-1 V'." in words
    assert "PI-2, own its gain is −2 V/V" in words


def test_definitions_are_printed_and_do_not_hide_behind_the_mouse(text):
    words = words_of(text).rpartition("What the numbers mean")[2]
    assert "never again lies outside a band for three samples in a row on one side" in words
    assert "16 a sensor that the law needs reports a fault" in words


def test_a_loop_without_a_linear_model_still_has_its_page(result):
    bare = tuple(replace(c, response=None, tuning=None) for c in result.ranking)
    words = words_of(report_text(replace(result, ranking=bare)))
    assert "There is no linear loop" in words
    assert "Margins, the other loops closed" not in words


def test_what_holds_for_the_process_is_said(result, text):
    assert all(warning in text for warning in result.warnings)


def test_a_report_stays_small(result, monkeypatch):
    # 4260 samples of eight signals in two runs are 950 kB as numbers of 14 letters.
    monkeypatch.setattr(html, "page_assets", lambda: None)
    assert len(report_text(result)) < 350_000
    monkeypatch.setattr(html, "page_assets", lambda: dict.fromkeys(ASSETS, ""))
    assert len(report_text(result)) < 450_000


@pytest.mark.thorough
def test_the_report_names_process_variant_and_study_file(result):
    process = load_process("equalisation-tank:relief")
    assert address_text(process) == "equalisation-tank:relief (catalogue)"
    own = replace(process, path=Path("basins/mine.toml"))
    assert address_text(own) == "basins/mine.toml:relief"
    assert "study file" not in words_of(report_text(result))
    named = words_of(report_text(replace(result, path=Path("weekly/compare.toml"))))
    assert "study file weekly/compare.toml process file quadruple-tank (catalogue)" in named
