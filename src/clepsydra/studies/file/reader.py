"""A study file → `StudyRequest`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from clepsydra.base.arguments import require_type
from clepsydra.base.errors import InputError
from clepsydra.base.input_file import read_input
from clepsydra.base.suggestion import suggestion
from clepsydra.linear.analysis import analyse
from clepsydra.process import told
from clepsydra.process.declared import table_schema
from clepsydra.process.document import kind_of, parse
from clepsydra.process.process import Process
from clepsydra.process.table_reader import TableReader
from clepsydra.scores.score import SCORES
from clepsydra.studies.file.controller_reader import controller_schema, read_controllers
from clepsydra.studies.file.process_reference import read_process
from clepsydra.studies.file.request import StudyRequest
from clepsydra.studies.file.scenario_reader import ScenarioTable, read_scenario

RANKING = told.table(
    {"scores": told.names('list of scores, each of all its signals or of one, `"iae[level]"`')},
    ("scores",),
)
STUDY = told.table(
    {
        "process": told.text(
            'a process of the catalogue, `"averaging-tank:inflow-constant"` with a variant, or the '
            "path of a process file, from the folder of the study file"
        ),
        "title": told.text("one line for people"),
        "seed": {
            "description": "whole number: of the measurement noise and of searches",
            "type": "integer",
            "minimum": 0,
        },
        "scenario": {
            "description": "table of what happens, see [Scenario](#scenario)",
            **table_schema(ScenarioTable),
        },
        "ranking": {"description": "table of what counts, see [Ranking](#ranking)", **RANKING},
        "controllers": told.by_name("a table for each controller", {"type": "object"}),
    },
    ("process",),
)


def study_schema() -> dict[str, Any]:
    """Return the JSON Schema of a study file, for editors.

    Examples
    --------
    >>> study_schema()["properties"]["seed"]["type"]
    'integer'
    """
    schema = "http://json-schema.org/draft-07/schema#"
    found = {"$schema": schema, "title": "Clepsydra study file", **STUDY}
    controllers = STUDY["properties"]["controllers"] | {"additionalProperties": controller_schema()}
    return found | {"properties": STUDY["properties"] | {"controllers": controllers}}


def read_study(path: str | Path, *, seed: int | None = None) -> StudyRequest:
    """Read a study file: process, scenario, controllers and what they are ranked by.

    Parameters
    ----------
    path : str or Path
        Of a TOML file; docs/study-files.md describes it.
    seed : int, optional
        In the place of the file's.

    Returns
    -------
    StudyRequest
        Its controllers are not made yet: `make` designs them.

    Raises
    ------
    InputError
        The file cannot be used: the message names line and key.
    NoEquilibrium
        The process has no operating point.

    Examples
    --------
    >>> import tempfile
    >>> text = '''process = "quadruple-tank"
    ... [controllers.tight]
    ... design = "simc"
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "compare.toml"
    ...     _ = file.write_text(text)
    ...     study = read_study(file)
    >>> [request.name for request in study.controllers], study.file_stem
    (['tight'], 'compare')
    """
    require_type(path, (str, Path), "study", "the path of a study file", "give it as text or Path")
    path = Path(path)
    document = parse(_content(path), str(path), "study")
    if kind_of(document) == "process":
        raise InputError(
            str(path),
            "a process file",
            'a study file, which names its process as in process = "quadruple-tank"',
            "write one with clepsydra new --study NAME --process FILE, or give the process itself "
            "to clepsydra study, which then tries every design",
        )
    general = TableReader(document, (), STUDY["properties"])
    process = read_process(general, path.parent)
    chosen = _seed(general) if seed is None else seed
    scores = _scores(general, process)
    controllers = read_controllers(general, process, path.parent)
    analysis = analyse(process)
    return StudyRequest(
        path=path,
        title=general.text("title", "one line of text", "correct it", default=process.title),
        process=process,
        analysis=analysis,
        scenario=read_scenario(general, analysis, chosen),
        controllers=controllers,
        scores=scores,
        seed=chosen,
    )


def is_study_file(text: str) -> bool:
    """Return whether a text that a user gave names a study file, rather than a process.

    A file that cannot be read or parsed is none: whoever reads it as a process says what is wrong.

    Examples
    --------
    >>> is_study_file("quadruple-tank")
    False
    """
    path = Path(text)
    try:
        if not text.lower().endswith(".toml") or not path.is_file():
            return False
        return kind_of(parse(_content(path), text, "study")) == "study"
    except (InputError, OSError, ValueError):
        return False


def _content(path: Path) -> bytes:
    return read_input(path, "a study file", inside="the .toml file")


def _seed(general: TableReader) -> int:
    value = general.raw("seed") if general.has("seed") else 1
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**63:
        raise general.refused(
            "seed", general.written("seed"), "a whole number from 0", "write as in seed = 1"
        )
    return value


def _scores(general: TableReader, process: Process) -> tuple[str, ...]:
    """Return what the controllers are ranked by."""
    if not general.has("ranking"):
        return ()
    table = general.table("ranking", "a table", "write [ranking]", RANKING["properties"])
    remedy = 'write as in scores = ["iae", "total_variation"]'
    names = table.names("scores", "a list of scores", remedy)
    for name in names:
        score, bracket, rest = name.partition("[")
        if score not in SCORES or (bracket and not rest.endswith("]")):
            raise table.refused(
                "scores",
                name[:60],
                f"scores of {', '.join(SCORES)}, of all their signals or of one, as in "
                '"iae[level_1]"',
                suggestion(score, SCORES, "choose from these"),
            )
        known = _signals(process)
        if bracket and rest[:-1] not in known:
            raise table.refused(
                "scores",
                name[:60],
                f"the score of a signal of {process.name} ({', '.join(known)})",
                suggestion(rest[:-1], known, "choose one of them"),
            )
    return names


def _signals(process: Process) -> list[str]:
    """Return everything that a score can be of."""
    found = [*process.controlled, *(signal.name for signal in process.inputs)]
    return list(dict.fromkeys([*found, *(element.name for element in process.elements)]))
