"""The structures of printed C: their members with comments, and where states stand."""

from __future__ import annotations

from collections.abc import Iterable

from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.printing.declarations import Variable, declared
from clepsydra.deploy.printing.heading import commented
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.owned_state import own_state, state_paths, with_owned_state
from clepsydra.program.program import Call, Program

#: A line with its comment is no wider than this [characters].
WIDTH = 98
_PLACEHOLDER = "char nothing; /* a structure of C99 has at least one member */"


def structure(name: str, what: str, title: str, variables: Iterable[Variable]) -> list[str]:
    """Return a structure of a program or of one of its blocks.

    Parameters
    ----------
    name : str
        What the names of its types begin with.
    what : str
        What the structure holds.
    title : str
        The comment above it.
    variables : iterable of Variable

    Examples
    --------
    >>> print("\\n".join(structure("law", "inputs", "Inputs.", [Variable("u", "double")])))
    /* Inputs. */
    typedef struct {
      double u;
    } law_inputs;
    <BLANKLINE>
    """
    members = []
    for each in variables:
        size = f"[{each.length}]" if each.length else ""
        line = f"{each.type} {each.name}{size};"
        wide = what == "state" and each.is_block and len(line) > WIDTH - 2
        members += [each.type, f"    {each.name};"] if wide else remarked(line, each.comment, 2)
    members = indented(members or [_PLACEHOLDER])
    return [f"/* {title} */", "typedef struct {", *members, f"}} {name}_{what};", ""]


def remarked(line: str, text: str, indent: int) -> list[str]:
    """Return a line of C with a comment, if there is any, that is to be indented.

    Examples
    --------
    >>> remarked("double u;", "[V]", 2)
    ['double u; /* [V] */']
    """
    return commented(line, text, "/*", "*/", WIDTH - indent)


def state_structure(
    program: Program, language: C99, name: str, title: str, origin: Origin | None = None
) -> list[str]:
    """Return the structure of what a program or a block keeps, its instances inside.

    Parameters
    ----------
    program : Program
    language : C99
    name, title : str
        See `structure`.
    origin : Origin, optional
        Where the numbers of the program come from; those of a block differ by instance.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (Signal("x"),), (), (), (), Block(1, (), (0,)))
    >>> state_structure(law, C99("law", "double"), "law", "State.")[2]
    '  double x; /* [1] */'
    """
    kept = declared(own_state(program), language, origin, program.rings)
    for call in instances(program):
        kind = f"{language.record(call.program.name)}_state"
        kept += (Variable(call.identifier, kind, is_block=True),)
    return structure(name, "state", title, kept)


def instances(program: Program) -> tuple[Call, ...]:
    """Return the calls of a printed program whose instances keep something.

    Examples
    --------
    See `state_structure`.
    """
    return tuple(call for call in program.calls if call.program.state)


def state_names(program: Program) -> dict[str, str]:
    """Return for the name of each state the one with the instances that it lives in.

    Examples
    --------
    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.program import Block, Operation
    >>> add = Block(2, (Operation(2, "add", (0, 1)),), (2, 2))
    >>> total = Program("total", (Signal("sum"),), (Signal("u"),), (), (Signal("y"),), add)
    >>> calls = Block(2, (Call((2, 3), total, "flow", (0, 1)),), (2, 3))
    >>> law = Program("law", (Signal("x"),), (Signal("u"),), (), (Signal("y"),), calls)
    >>> state_names(law)
    {'x': 'flow.sum'}
    """
    names = [entry.name for entry in program.state]
    paths = state_paths(with_owned_state(program))
    return {
        name: ".".join(path) if len(path) > 1 else name
        for name, path in zip(names, paths, strict=True)
    }
