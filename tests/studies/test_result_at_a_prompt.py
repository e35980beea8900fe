"""A study at a prompt."""

from pathlib import Path

from clepsydra.studies.file.reader import read_study
from clepsydra.studies.study import run_study

STUDY = """
process = "{process}"
[scenario]
duration = "2 min"
[[scenario.setpoint]]
signal = "level_1"
at = "10 s"
by = "1 cm"
[controllers.plain]
design = "simc"
[controllers.ahead]
design = "smith_predictor"
"""


def test_it_is_a_few_lines(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY.format(process=Path(__file__).parents[1] / "one-tank.toml"))
    result = run_study(read_study(path))
    said = "1 controller, best plain; 1 not applicable"
    assert repr(result) == f"<StudyResult of {result.process.address}: {said}>"
    lines = str(result).splitlines()
    assert lines[0] == result.verdict and lines[1:] == [repr(c) for c in result.ranking]
