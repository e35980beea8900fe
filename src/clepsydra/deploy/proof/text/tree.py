"""The parse tree of Structured Text, by the public grammar tree-sitter-iec61131-3-st."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from clepsydra.base.errors import ClepsydraError, Finding, InputError

if TYPE_CHECKING:
    from tree_sitter import Node


class StructuredTextError(ClepsydraError):
    """The text is wrong, or does something that the standard leaves undefined."""


def parse(text: str) -> Node:
    """Return the root of the parse tree.

    Raises
    ------
    InputError
        The grammar is not installed.
    StructuredTextError
        The grammar does not accept the text; the message names the line.

    Examples
    --------
    >>> parse("PROGRAM p\\nEND_PROGRAM").type
    'source_file'
    >>> parse("PROGRAM p\\nVAR x : ; END_VAR\\nEND_PROGRAM")
    Traceback (most recent call last):
        ...
    clepsydra.deploy.proof.text.tree.StructuredTextError: line 2: the grammar does not accept \
'VAR x : ; END_VAR'
    """
    try:
        import tree_sitter_iec61131_3_st
        from tree_sitter import Language, Parser
    except ImportError as error:
        raise InputError(
            "proof of Structured Text",
            Finding(f"no package {error.name}"),
            "the grammar of Structured Text",
            "pip install 'clepsydra[verify]'",
        ) from None
    tree = Parser(Language(tree_sitter_iec61131_3_st.language())).parse(text.encode())
    if tree.root_node.has_error:
        wrong = next(node for node in walk(tree.root_node) if node.is_error or node.is_missing)
        line = text.splitlines()[wrong.start_point[0]] if text else ""
        raise StructuredTextError(
            f"line {wrong.start_point[0] + 1}: the grammar does not accept {line.strip()!r}"
        )
    return tree.root_node


def walk(node: Node) -> Iterator[Node]:
    """Yield a node and all below it."""
    yield node
    for child in node.children:
        yield from walk(child)


def content(node: Node) -> str:
    """Return the text of a node."""
    assert node.text is not None
    return node.text.decode()


def part(node: Node, field: str) -> Node:
    """Return the part of a node that stands in a field.

    Raises
    ------
    StructuredTextError
        There is none.
    """
    found = node.child_by_field_name(field)
    if found is None:
        raise wrong(node, f"a {node.type} without {field}")
    return found


def wrong(node: Node, message: str) -> StructuredTextError:
    """Return an error that names the line of a node."""
    return StructuredTextError(f"line {node.start_point[0] + 1}: {message}")
