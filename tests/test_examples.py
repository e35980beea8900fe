"""The scripts of docs/examples run, and print what physics or another way of computing says."""

import math
import re
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from rich.console import Console
from scipy.optimize import brentq
from tools import need, need_compiler

import clepsydra as cl

FOLDER = Path(__file__).parent.parent / "docs" / "examples"
#: Examples on which nothing simpler is good enough.
PLANNED = {"analyser.toml", "sample-line.toml", "blending-station.toml"}
NUMBER = r"(-?\d+\.?\d*)"
#: The tank of `cl.new_process`: pump [cm³/(s V)], at rest [V], hole [cm²]; 2 g [cm/s²].
PUMP, REST, HOLE, TWICE_GRAVITY = 3.33, 6.0, 0.15, 2 * 981.0
#: A hole of the quadruple tank [cm²].
OF_FOUR = 0.071


@pytest.fixture
def printed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")

    def run(name: str) -> str:
        runpy.run_path(str(FOLDER / f"{name}.py"))
        plt.close("all")
        return capsys.readouterr().out

    return run


def numbers(pattern: str, text: str) -> list[float]:
    """Return what stands at # in each place where the pattern does."""
    found = re.findall(pattern.replace("#", NUMBER), text, re.MULTILINE)
    assert found, f"{pattern} is not in\n{text}"
    return [float(value) for value in found]


def time_constant(flow: float) -> float:
    """Return that of the tank of `cl.new_process`, 28 cm² wide, at a flow [cm³/s], in s."""
    level = (flow / HOLE) ** 2 / TWICE_GRAVITY
    return 28.0 / HOLE * math.sqrt(2 * level / 981.0)


def test_every_script_says_what_it_answers_and_is_short():
    scripts = sorted(FOLDER.glob("*.py"))
    assert scripts
    for script in scripts:
        first, *rest = script.read_text().splitlines()
        assert first.startswith("# ") and "?" in first, script
        assert 5 <= len([line for line in rest if line]) <= 15, script


@pytest.fixture(scope="module")
def drum():
    return cl.load(FOLDER / "surge-drum.toml")


def test_surge_drum_is_the_file_of_the_page():
    page = (FOLDER.parent / "averaging-levels.md").read_text(encoding="utf-8")
    assert (FOLDER / "surge-drum.toml").read_text(encoding="utf-8") in page


def test_surge_drum_by_its_rule(drum):
    """15 m³/h less at a surface of 2 √(0.7 · 1.3) m × 6 m, and 0.95 · 0.4 m of room, ζ = 1.

    With the smallest surface throughout the level goes to 0.38 m; with that at rest, a twelfth
    larger, the fastest change is smaller by as much.
    """
    run = cl.simulate(drum, cl.design.arrest_time(drum))
    smallest, at_rest = 12.0 * math.sqrt(0.7 * 1.3), 12.0
    fastest = 2.0 / math.e * 15.0**2 / 0.38  # [m³/h per h] by m²
    change = run.scores["outflow_rate[level]"]
    assert fastest / at_rest < change < fastest / smallest
    assert 0.9 * 0.4 < run.scores["peak_deviation[level]"] * 2.0 < 0.38
    assert run.scores["time_outside_band[level]"] == 0.0


@pytest.mark.thorough
def test_surge_drum(studied, monkeypatch):
    """PI with a damping of 0.7 changes the outflow by 0.64 ΔF²/(A y), and a ramp by 0.50."""
    monkeypatch.chdir(FOLDER)
    study = studied("surge-drum.toml")
    best = study.best
    assert best.controller.name == "PI, arrest time, tuned"
    ramp = 0.5 * 15.0**2 / 0.4  # [m³/h per h] by m²
    # With a damping of 0.7, which is kept, 0.64 ΔF²/(A y); the surface is smaller at the end.
    damped = 0.64 / 0.5 * ramp
    change = best.scores["outflow_rate[level]"]
    assert damped / 12.0 < change < 1.1 * damped / (12.0 * math.sqrt(0.91))
    level = best.run.true_measurement("level")
    assert 0.3 - 1e-4 <= level.min() < 0.31 and level.max() < 0.7
    kept = [each for each in study.ranking if each.standing.name == "ROBUST"]
    assert all(each.scores["time_outside_band[level]"] == 0.0 for each in kept)
    assert study.verdict.startswith("Use PI, arrest time, tuned on Surge drum: the best, with an ")


def test_open_loop_step(printed):
    """The level in the end is that at which the hole lets out what comes in (Torricelli)."""
    inflow = 0.70 * 3.33 * 3.2 + (1 - 0.60) * 3.35 * 3.0
    level = 0.5 * (inflow / OF_FOUR) ** 2 / TWICE_GRAVITY
    assert numbers(r"level_1: .* V to # V", printed("open_loop_step")) == [
        pytest.approx(level, abs=0.01)
    ]


def test_own_law(printed):
    """P control rests where the hole lets out what pump and load bring; PI on its setpoint."""
    at_rest = (PUMP * REST / HOLE) ** 2 / TWICE_GRAVITY

    def balance(level: float) -> float:
        inflow = PUMP * (REST - 2.0 * (level - at_rest)) + 2.0
        return inflow - HOLE * math.sqrt(TWICE_GRAVITY * level)

    offset = 10.0 * (brentq(balance, at_rest, at_rest + 1.0) - at_rest)
    assert numbers(r": # mm", printed("own_law")) == [
        pytest.approx(offset, abs=0.01),
        pytest.approx(0.0, abs=0.01),
    ]


@pytest.mark.thorough
def test_compare_three_pi(printed):
    """∫ e dt = Ti Δu / K: twice the gain at the same Ti halves the error of a level."""
    text = printed("compare_three_pi")
    bold, usual, calm = (
        numbers(f"{name} .*level_1 +# ", text)[0] for name in ("bold", "usual", "calm")
    )
    assert bold / usual == pytest.approx(0.5, rel=0.1)
    assert calm > usual


@pytest.mark.thorough
def test_tune_with_overshoot_limit(printed):
    text = printed("tune_with_overshoot_limit")
    assert numbers("overshoot # %", text)[-1] <= 5.0
    assert numbers(r"IAE # V s, tuned", text)[0] > numbers(r"tuned # V s", text)[0]


def test_own_plant_to_structured_text(printed):
    """SIMC on a slope k' takes Ti = 4 / (k' K), and k' follows from pump, area and ranges."""
    text = printed("own_plant_to_structured_text")
    slope = PUMP * 10.0 / (40.0 * 20.0)  # [%/% per s]
    gain, time = numbers("K = # %/%", text)[0], numbers("Ti = # s", text)[0]
    assert time == pytest.approx(4 / (slope * gain), rel=0.01)


def test_identify_and_retune(printed):
    """The pump has 80 % of what was believed: Ti is not 4 / (k' K), but the shorter time constant.

    A setpoint step by 10 % may move the pump by the 40 % that it has left, whence K = 4 %/%.
    """
    text = printed("identify_and_retune")
    assert numbers("pump_1.gain #", text) == [pytest.approx(0.8 * PUMP, rel=0.005)]
    believed, found = numbers("Ti = # s", text)
    assert believed == pytest.approx(4 / (4.0 * PUMP * 10.0 / (28.0 * 20.0)), rel=0.01)
    assert found == pytest.approx(time_constant(0.8 * PUMP * REST), rel=0.01)


def test_robustness(printed):
    """A wider tank is slower: the worst of 200 has all but the widest tanks that may be."""
    text = printed("robustness")
    on_paper, *_ = numbers("IAE # V s", text)
    quantile, worst, again = numbers("^#(?= V s)", text) + numbers("again # V s", text)
    (wide,) = numbers("tanks x #,", text)
    assert on_paper < quantile < worst == again
    # That none of 200 plants is within a tenth of the upper end has a chance of 7e-10.
    assert 1.16 < wide <= 1.2


@pytest.mark.thorough
def test_lqi_with_weights(printed):
    """A dearer error of level_1 becomes smaller, and the cheaper one of level_2 larger."""
    text = printed("lqi_with_weights")
    (even_1, uneven_1), (even_2, uneven_2) = (numbers(f"'level_{i}': #", text) for i in (1, 2))
    assert uneven_1 < even_1 and uneven_2 > even_2


@pytest.mark.thorough
def test_smith_predictor(printed):
    text = printed("smith_predictor")
    smith, pi = (numbers(f"{name}.*IAE # m min", text)[0] for name in ("Smith", "PI"))
    assert smith < pi
    assert max(numbers(r"max\|S\| #", text)) <= 2.0 + 0.005  # as printed


@pytest.mark.thorough
def test_notebook_with_plots(printed, tmp_path):
    """With an integral the level comes to its setpoint, 1 V above where it rests."""
    text = printed("notebook_with_plots")
    at_rest = 0.5 * ((0.70 * 3.33 * 3.0 + 0.40 * 3.35 * 3.0) / OF_FOUR) ** 2 / TWICE_GRAVITY
    assert all(at_rest + 0.99 <= peak <= at_rest + 1.2 for peak in numbers("': #", text))
    assert all((tmp_path / name).stat().st_size > 5000 for name in ("pi.png", "both.png"))


def test_python_control_object(printed):
    """Its poles are those of s² + (1/T + k K) s + k K / Ti, by hand."""
    text = printed("python_control_object")
    lag = time_constant(PUMP * REST)
    slope = PUMP * 10.0 / (28.0 * 20.0)
    gain, time = 4.0, 4 / (4.0 * slope)
    first, second = numbers("poles .*?#", text)[0], numbers(r"poles \[-\d.*?j +#", text)[0]
    assert -(first + second) == pytest.approx(1 / lag + gain * slope, abs=0.002)
    assert first * second == pytest.approx(gain * slope / time, rel=0.05)


@pytest.mark.thorough
def test_export_and_verify(printed):
    need_compiler()
    need("fmpy", "tree_sitter_iec61131_3_st")
    assert "The proof holds" in printed("export_and_verify")


def test_quansers_tanks_rest_and_respond_as_torricelli_says():
    """At 15 cm in both, the pump brings what the holes let out, and each tank lags by 2 V / q."""
    plant = cl.load(FOLDER / "quanser-coupled-tanks.toml")
    flow = 0.25 * math.pi * (2.54 * 3 / 16) ** 2 * math.sqrt(TWICE_GRAVITY * 15.0)
    assert plant.point.as_dict()["pump"] == pytest.approx(flow / 3.3, rel=1e-3)
    lag = 2 * 15.0 * 0.25 * math.pi * 4.445**2 / flow
    assert cl.analyse(plant).time_constants == pytest.approx([lag, lag], rel=2e-3)


def test_the_blending_station_rests_where_salt_and_liquid_balance():
    plant = cl.load(FOLDER / "blending-station.toml")
    brine = 5.0 * 50.0 / 250.0  # [m³/h]
    water = 1.0 + math.log((5.0 - brine) / 8.0, 50.0)  # the valve's opening, at 1 bar
    at_rest = plant.point.as_dict()
    assert at_rest["dosing"] == pytest.approx(brine / 3.0, rel=1e-6)
    assert at_rest["water"] == pytest.approx(water, rel=1e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("name", [path.name for path in sorted(FOLDER.glob("*.toml"))])
def test_a_plant_is_studied_in_a_screen_and_exported(studied, name, tmp_path, monkeypatch):
    monkeypatch.chdir(FOLDER)
    study = studied(name)
    for columns in (80, 100):
        console = Console(width=columns)
        with console.capture() as shown:
            console.print(study)
        lines = [line.rstrip() for line in shown.get().splitlines()]
        assert len(lines) <= 24 and max(map(len, lines)) <= columns
        loops = any(line.startswith("ISA settings, ") for line in lines)
        assert loops != (name in PLANNED)
    assert (study.recommended.controller.name == "MPC") == (name in PLANNED)
    written = cl.export(study.recommended.controller, study.plant, tmp_path, to="st")
    assert all(path.stat().st_size for path in written.files)
