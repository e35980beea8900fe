"""`cl.new_process`, `cl.new_study` and `cl.new_lesson`: a commented file to begin with."""

from __future__ import annotations

import re
from importlib import resources
from pathlib import Path

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import InputError, reason_of
from clepsydra.base.standing import Standing, standing_at
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.flat_variant import flat_text
from clepsydra.process.process_name import check_process_name
from clepsydra.process.variants import split_variants

#: The process of a study for which none is named.
STUDIED = "quadruple-tank"


def new_process(name: str, *, copy_of: str | None = None, folder: str | Path = ".") -> Path:
    """Write a commented process file to begin with; over none that is there.

    Parameters
    ----------
    name : str
        Of the process; the file is NAME.toml.
    copy_of : str, optional
        A process of the catalogue to copy; a variant, "averaging-tank:inflow-constant", is written
        into the copy.
    folder : str or Path

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        The name cannot be used, the file is there already or cannot be written, or there is no
        such process.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as here:
    ...     new_process("my-tanks", copy_of="quadruple-tank", folder=here).name
    'my-tanks.toml'
    """
    check_process_name(name, "name")
    text = _template("new_process") if copy_of is None else _catalogue(copy_of)
    path = Path(folder, f"{name}.toml")
    _check_free(path, name)
    _write(path, name, _renamed(text, name))
    return path


def new_study(name: str, process: str = STUDIED, *, folder: str | Path = ".") -> Path:
    """Write a commented study file, which names controllers, scenario and ranking.

    Parameters
    ----------
    name : str
        Of the study; the file is NAME.toml.
    process : str
        What is studied: a process of the catalogue, or the path of a process file.
    folder : str or Path

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        As `new_process`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as here:
    ...     new_study("compare", "three-tanks", folder=here).name
    'compare.toml'
    """
    name, path = _free_path(name, folder)  # before the process is analysed
    _write(path, name, _study(process))
    return path


def new_lesson(name: str, *, folder: str | Path = ".") -> Path:
    """Write a commented lesson file, a laboratory with tasks.

    Parameters
    ----------
    name : str
        Of the lesson; the file is NAME.toml.
    folder : str or Path

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        As `new_process`.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as here:
    ...     new_lesson("first-steps", folder=here).name
    'first-steps.toml'
    """
    name, path = _free_path(name, folder)
    _write(path, name, _template("new_lesson"))
    return path


def _free_path(name: str, folder: str | Path) -> tuple[str, Path]:
    """Return a name without the ending of its file, and that file, which is not there yet."""
    name = name.removesuffix(".toml")
    check_process_name(name, "name")
    path = Path(folder, f"{name}.toml")
    _check_free(path, name)
    return name, path


def _check_free(path: Path, name: str) -> None:
    place, expected, remedy = _wanted(path)
    if standing_at(path, place, expected, remedy, name) is not Standing.NOTHING:
        raise InputError(place, name, expected, remedy)


def _wanted(path: Path) -> tuple[str, str, str]:
    return "name", f"a name for which there is no {path} yet", "choose another name"


def _write(path: Path, name: str, text: str) -> None:
    try:
        # Opened only if it does not exist, so that nothing is ever written over.
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        place, expected, remedy = _wanted(path)
        raise InputError(place, name, expected, remedy) from None
    except OSError as error:
        remedy = f"change the folder ({reason_of(error)})"
        raise InputError("name", str(path), "a file that can be written", remedy) from None


def _template(name: str) -> str:
    return (resources.files("clepsydra.interface") / f"{name}.toml").read_text(encoding="utf-8")


def _study(named: str) -> str:
    from clepsydra.process.reader import load_process
    from clepsydra.studies.file.new_study import new_study as study_text

    return study_text(load_process(named), named, _template("new_study"))


def _catalogue(named: str) -> str:
    name, variants = split_variants(named)
    require_known("copy_of", name, catalogue_names(), "a process of the catalogue")
    text = catalogue_file(name).read_text(encoding="utf-8")
    return text if variants is None else flat_text(text, name, variants)


def _renamed(text: str, name: str) -> str:
    """Return a process file with another name; its comments and its order stay."""
    return re.sub(r'^name = ".*"$', f'name = "{name}"', text, count=1, flags=re.MULTILINE)
