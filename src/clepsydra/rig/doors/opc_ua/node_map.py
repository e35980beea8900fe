"""Which node of a server of OPC UA holds which tag."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from clepsydra.base.csv_table import csv_rows
from clepsydra.base.errors import Finding, InputError
from clepsydra.base.suggestion import suggestion
from clepsydra.rig.doors.opc_ua.address_space import NAMESPACE
from clepsydra.rig.tag import Tag

_COLUMNS = ("tag", "node")
_MOST_ROWS = 100_000
#: A namespace by its name, which is told apart from one by its number (OPC 10000-6, 5.3.1.10).
_BY_NAME = "nsu="


@dataclass(frozen=True)
class NodeMap:
    """The nodes of tags in a server.

    Parameters
    ----------
    nodes : mapping
        Name of a tag to the identifier of its node: "ns=4;s=|var|PLC.Application.GVL.level", or
        "nsu=urn:plc:program;s=level" with the name of the namespace in place of its number, which
        changes where a server gets another one.
    tags : mapping
        Name to tag.
    """

    nodes: Mapping[str, str]
    tags: Mapping[str, Tag]

    @property
    def mapped(self) -> tuple[Tag, ...]:
        """The tags that have a node."""
        return tuple(self.tags[name] for name in self.nodes)


def nodes_of_rig(tags: Iterable[Tag]) -> NodeMap:
    """Return the nodes that a rig's own server has.

    Examples
    --------
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> found = nodes_of_rig(tags_of(cl.load("quadruple-tank").point))
    >>> found.nodes["level_1.pv"]
    'nsu=urn:clepsydra:rig;s=level_1.pv'
    """
    known = {tag.name: tag for tag in tags}
    return NodeMap({name: f"{_BY_NAME}{NAMESPACE};s={name}" for name in known}, known)


def read_node_map(path: Path, tags: Iterable[Tag]) -> NodeMap:
    """Read the nodes of tags from CSV, with the columns "tag" and "node".

    Parameters
    ----------
    path : Path
    tags : iterable of Tag
        All that there are; one may be left out of the file.

    Raises
    ------
    InputError
        With the line: a column is missing, a tag is unknown or stands there twice, or what stands
        for a node is none.

    Examples
    --------
    >>> import tempfile
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "nodes.csv")
    ...     _ = file.write_text("tag,node\\nlevel_1.pv,ns=4;s=GVL.level_1\\n")
    ...     read_node_map(file, tags).nodes
    {'level_1.pv': 'ns=4;s=GVL.level_1'}
    """
    (line, head), *rows = csv_rows(path, _MOST_ROWS)
    names = [cell.strip() for cell in head]
    for column in _COLUMNS:
        if column not in names:
            raise InputError(
                f"{path}, line {line}", ", ".join(names), f"a column {column!r}",
                "let the first line be: tag,node",
            )  # fmt: skip
    tag_at, node_at = (names.index(column) for column in _COLUMNS)
    known = {tag.name: tag for tag in tags}
    nodes: dict[str, str] = {}
    for line, cells in rows:
        if not any(cell.strip() for cell in cells):
            continue
        place = f"{path}, line {line}"
        name, node = (cells[at].strip() if at < len(cells) else "" for at in (tag_at, node_at))
        if name not in known:
            near = suggestion(name, known, "see rig --map for all tags")
            raise InputError(place, name, "a tag of the rig", near)
        if name in nodes:
            raise InputError(place, name, "each tag once", "remove one of its lines")
        _check_node(place, node)
        nodes[name] = node
    return NodeMap(nodes, known)


def _check_node(place: str, node: str) -> None:
    beginning, _, identifier = node.rpartition(";")
    kind, _, value = identifier.partition("=")
    numbered = kind != "i" or (value.isdecimal() and int(value) < 1 << 32)
    where = beginning.startswith(_BY_NAME) and len(beginning) > len(_BY_NAME)
    where = where or beginning == "" or (beginning[:3] == "ns=" and beginning[3:].isdecimal())
    if kind not in ("i", "s", "g", "b") or not value or not numbered or not where:
        raise InputError(
            place, node or Finding("nothing"), "the identifier of a node: ns=4;s=GVL.level",
            "take it from the properties of the node in a browser of OPC UA",
        )  # fmt: skip
