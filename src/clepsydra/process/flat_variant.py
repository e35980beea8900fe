"""A process file with variants written into it, as if it had never had any."""

from __future__ import annotations

import re
import tomllib

from clepsydra.process.document import parse
from clepsydra.process.toml_lines import Entry, Path, entries
from clepsydra.process.variants import VARIANT_KEYS, choose_variants

#: Comments that stand right above something belong to it.
_COMMENTS = re.compile(r"(?:^[ \t]*#[^\n]*\n)+\Z", re.MULTILINE)


def flat_text(text: str, file: str, variants: tuple[str, ...]) -> str:
    """Return a process file in which what variants say stands where it applies.

    Comments and order stay. A value that a variant gives takes the place of the old one, with
    the variant's comment behind it; what the variant adds follows in its table or at the end.

    Parameters
    ----------
    file : str
        Its name, for messages.
    variants : tuple of str
        Laid over the file in this order.

    Examples
    --------
    >>> text = '''name = "a"
    ... [pumps.feed]
    ... nominal = "3 V"  # of the trial
    ... [variants.fast]
    ... pumps.feed.nominal = "5 V"
    ... '''
    >>> print(flat_text(text, "a.toml", ("fast",)), end="")
    name = "a"
    [pumps.feed]
    nominal = "5 V"
    """
    chosen = choose_variants(parse(text.encode(), file), variants)
    found = list(entries(text))
    base = [entry for entry in found if entry.path[0] not in VARIANT_KEYS]
    brought = [
        ((*here, *entry.path[len(there) :]), entry)
        for here, there in chosen.document.origins.items()
        for entry in found
        if entry.path[: len(there)] == there
    ]
    values = {path: text[e.value : e.end] for path, e in brought if not e.is_table}
    new_tables = {path: "" for path, entry in brought if entry.is_table}
    ends = _ends(base)
    edits = [(_begin(text, e.start), e.end, "") for e in found if e.path[0] in VARIANT_KEYS]
    for entry in base:
        if not entry.is_table and entry.path in values:
            edits.append((entry.value, entry.end, values.pop(entry.path)))
    for path, value in values.items():
        table, line = path[:-1], f"\n{path[-1]} ={value}"
        if table in ends:
            edits.append((ends[table], ends[table], line))
        else:
            new_tables[table] = new_tables.get(table, "") + line
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    flat = re.sub(r"\n{3,}", "\n\n", text).strip("\n") + "\n"
    flat += "".join(f"\n[{'.'.join(table)}]{lines}\n" for table, lines in new_tables.items())
    assert tomllib.loads(flat) == chosen.document.tables, f"{file} is written too freely"
    return flat


def _ends(base: list[Entry]) -> dict[Path, int]:
    """Return where the last line of each table ends that has a heading, and of the top."""
    ends: dict[Path, int] = {}
    table: Path = ()
    for entry in base:
        table = entry.path if entry.is_table else table
        ends[table] = entry.end
    return ends


def _begin(text: str, start: int) -> int:
    """Return where the comments begin that stand right above a line."""
    above = _COMMENTS.search(text, 0, start)
    return above.start() if above else start
