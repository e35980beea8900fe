"""What a command printed and wrote, as values that two commits can be compared by.

JSON stays as it is, a table becomes a few numbers a column, any other text its digest. What two
runs of one commit may differ in is taken out first, each by what it is: a path of the run by
the path, a moment by its lying within the run, a version by its being Clepsydra's, and what
a key or a heading says is a time or a list of tool versions.
"""

from __future__ import annotations

import datetime
import hashlib
import io
import json
import re
import zipfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

#: Keys of JSON, of each verb, whose values are times, or versions of tools.
_KEYS = {"verify": {"seconds": "times", "versions": "versions", "version": "versions"}}
#: Columns of a Markdown table and lines that say the same to a reader.
_COLUMNS = {"verify": {"s": "times"}}
_LINES = {"verify": (re.compile(r"(?<=seed \d; ).*(?=\.$)", re.MULTILINE), "versions")}
_MOMENT = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|[+-]\d\d:?\d\d)?")
_TABLES = {".parquet", ".csv"}


@dataclass
class Normaliser:
    """Takes out what a run and not the commit decides, and counts it.

    Parameters
    ----------
    verb : str
        Of the command.
    paths : dict
        Path of this run to what stands for it.
    version : str
        Of Clepsydra at the commit.
    began : datetime
        Of the run, with its time zone; a moment within a day of it is the run's.
    """

    verb: str
    paths: dict[str, str]
    version: str
    began: datetime.datetime
    left_out: Counter[str] = field(default_factory=Counter)

    def text(self, text: str) -> str:
        """Return a text without paths, moments and Clepsydra's own version."""
        for path in sorted(self.paths, key=len, reverse=True):
            self.left_out["paths"] += text.count(path)
            text = text.replace(path, self.paths[path])
        own = rf"(clepsydra |productVersion=\")v?{re.escape(self.version)}(?![\w.]*\d)"
        text, count = re.subn(own, r"\1<version>", text, flags=re.IGNORECASE)
        self.left_out["versions"] += count
        return _MOMENT.sub(self._moment, text)

    def markdown(self, text: str) -> str:
        """Return a page without the cells and lines that are times or versions as well."""
        heads = _COLUMNS.get(self.verb, {})
        lines: list[str] = []
        columns: dict[int, str] = {}
        for line in text.splitlines():
            cells = line.split("|")
            if len(cells) < 3:
                columns = {}
            elif not columns:
                columns = {n: kind for n, c in enumerate(cells) if (kind := heads.get(c.strip()))}
            else:
                for number, kind in columns.items():
                    self.left_out[kind] += 1
                    cells[number] = f"<{kind}>"
            lines.append("|".join(cells))
        whole = "\n".join(lines)
        if self.verb in _LINES:
            pattern, kind = _LINES[self.verb]
            whole, count = pattern.subn(f"<{kind}>", whole)
            self.left_out[kind] += count
        return self.text(whole)

    def document(self, value: Any) -> Any:
        """Return the values of JSON without those whose key says that they are left out."""
        if isinstance(value, dict):
            keys = _KEYS.get(self.verb, {})
            self.left_out.update(keys[key] for key in value if key in keys)
            return {key: self.document(value[key]) for key in value if key not in keys}
        if isinstance(value, list):
            return [self.document(entry) for entry in value]
        return value

    def _moment(self, found: re.Match[str]) -> str:
        try:
            moment = datetime.datetime.fromisoformat(found[0])
        except ValueError:
            return found[0]
        moment = moment if moment.tzinfo else moment.replace(tzinfo=datetime.UTC)
        if abs(moment - self.began) > datetime.timedelta(days=1):
            return found[0]  # a date of the contents
        self.left_out["dates"] += 1
        return "<date>"


def read_printed(text: str, normaliser: Normaliser) -> Any:
    """Return what was printed: the values of JSON, or the text."""
    text = normaliser.text(text)
    try:
        return normaliser.document(json.loads(text))
    except json.JSONDecodeError:
        return text


def read_files(folder: Path, normaliser: Normaliser) -> dict[str, Any]:
    """Return every file below a folder by its name, except those with a leading dot."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    names = {path: path.relative_to(folder).as_posix() for path in files}
    return {
        name: read_file(name, path.read_bytes(), normaliser)
        for path, name in names.items()
        if not name.startswith(".")
    }


def read_file(name: str, content: bytes, normaliser: Normaliser) -> Any:
    """Return what a file is compared by, from its ending and its content."""
    ending = Path(name).suffix.lower()
    if ending == ".fmu":
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return {
                entry: read_file(entry, archive.read(entry), normaliser)
                for entry in sorted(archive.namelist())
                if not entry.endswith("/")
            }
    if ending in _TABLES:
        return _table(ending, content)
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        return _digest(content)
    if ending == ".json":
        return read_printed(text, normaliser)
    clean = normaliser.markdown(text) if ending == ".md" else normaliser.text(text)
    return _digest(clean.encode())


def _digest(content: bytes) -> str:
    return "sha256 " + hashlib.sha256(content).hexdigest()[:16]


def _table(ending: str, content: bytes) -> dict[str, Any]:
    """Return rows and, of each column of numbers, a few that no change of trajectory keeps."""
    import numpy as np
    import pyarrow.csv
    import pyarrow.parquet

    stream = io.BytesIO(content)
    table = pyarrow.csv.read_csv(stream) if ending == ".csv" else pyarrow.parquet.read_table(stream)
    columns: dict[str, Any] = {}
    for name in table.column_names:
        column = table.column(name)
        if not pyarrow.types.is_floating(column.type) and not pyarrow.types.is_integer(column.type):
            columns[name] = _digest("\n".join(map(str, column.to_pylist())).encode())
            continue
        values = column.to_numpy().astype(float)
        finite = values[np.isfinite(values)]
        weights = np.arange(1, len(finite) + 1) / max(len(finite), 1)
        columns[name] = {
            "not finite": len(values) - len(finite),
            "mean size": float(np.abs(finite).mean()) if len(finite) else 0.0,
            "mean size, weighted by its row": float((np.abs(finite) * weights).mean())
            if len(finite)
            else 0.0,
            "smallest": float(finite.min()) if len(finite) else 0.0,
            "largest": float(finite.max()) if len(finite) else 0.0,
        }
    metadata = {k.decode(): v.decode() for k, v in (table.schema.metadata or {}).items()}
    metadata.pop("pandas", None)
    return {"rows": table.num_rows, "columns": columns, "metadata": metadata}
