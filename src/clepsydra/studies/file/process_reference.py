"""The process that a study file names."""

from __future__ import annotations

from pathlib import Path

from clepsydra.base.suggestion import suggestion
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process
from clepsydra.process.table_reader import TableReader
from clepsydra.process.variants import split_variants


def read_process(general: TableReader, folder: Path) -> Process:
    """Read the process of a study file: one of the catalogue, or a file beside the study file.

    Parameters
    ----------
    general : TableReader
        The whole study file.
    folder : Path
        Where the study file is: the path of a process file starts there.

    Raises
    ------
    InputError
        There is no such process or variant, or its own file is wrong.

    Examples
    --------
    >>> from clepsydra.process.document import parse
    >>> text = b'process = "averaging-tank:inflow-constant"'
    >>> read_process(TableReader(parse(text, "study.toml"), (), None), Path()).variant
    ('inflow-constant',)
    """
    expected = "a process of the catalogue, or the path of a process file"
    written = general.text("process", expected, 'write as in process = "quadruple-tank"')
    name, variants = split_variants(written)
    names = catalogue_names()
    if name in names:
        return load_process(name, variants)
    path = folder / name
    if not path.is_file():
        raise general.refused(
            "process",
            written[:60],
            f"{expected} ({', '.join(names)})",
            suggestion(name, names, f"check the path, which starts in the folder {folder}/"),
        )
    return load_process(path, variants)
