"""A blending tank whose analyser takes its time and reports at times."""

from pathlib import Path

import clepsydra as cl

FILE = Path(__file__).parents[2] / "docs" / "examples" / "analyser.toml"
LATE = 'dead_time = "40 s"'
SENSORS = (LATE, 'sampling = "1 min"', f'{LATE}\nsampling = "1 min"\nfirst_report = "30 s"')


def with_analyser(folder: Path, sensor: str) -> cl.Plant:
    """Load the plant with this analyser."""
    text = FILE.read_text(encoding="utf-8")
    assert LATE in text
    path = folder / "analyser.toml"
    path.write_text(text.replace(LATE, sensor), encoding="utf-8")
    return cl.load(path)
