"""The structures of printed C: their members with comments, where states stand, and their size."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from clepsydra.deploy.c99.statements import C99
from clepsydra.deploy.printing.declarations import Variable, declared
from clepsydra.deploy.printing.heading import commented
from clepsydra.deploy.printing.lines import indented
from clepsydra.deploy.printing.origin import Origin
from clepsydra.deploy.printing.precision import Precision
from clepsydra.program.entries import is_ring, signal_of
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


_REAL = {"double": 8, "single": 4}
_POSITION = 4


def state_size(program: Program, precision: Precision = "double") -> int:
    """Return the size of the state structure, for one instance [bytes].

    As compilers lay structures out where every type stands at a multiple of its own size (64-bit
    processors, ARM): on 32-bit x86 of Unix, where doubles stand at multiples of four bytes, it
    may be four bytes less.

    Parameters
    ----------
    program : Program
    precision : {"double", "single"}

    Examples
    --------
    A state of three numbers and a truth value, and a delay by ten samples with its position:

    >>> from clepsydra.base.signal import Signal
    >>> from clepsydra.program.delay_ring import DelayRing
    >>> from clepsydra.program.program import Block
    >>> state = (Signal("a"), Signal("b"), Signal("c"), Signal("hand", kind="boolean"),
    ...          DelayRing(Signal("flow", "m^3/s"), 10))
    >>> program = Program("law", state, (), (), (), Block(5, (), (0, 1, 2, 3, 4)))
    >>> state_size(program), state_size(program, "single")
    (120, 60)
    """
    return _extent(with_owned_state(program), precision)[0]


def _extent(program: Program, precision: Precision) -> tuple[int, int]:
    """Return the size of a structure and that of its widest member's type [bytes]."""
    size, widest = 0, 1
    for width, aligned in _members(program, precision):
        size += -size % aligned + width
        widest = max(widest, aligned)
    return max(size + -size % widest, 1), widest


def _members(program: Program, precision: Precision) -> Iterator[tuple[int, int]]:
    """Yield of each member how much it takes, and at a multiple of what it stands [bytes]."""
    widths = {"real": _REAL[precision], "integer": 4, "boolean": 1}
    for entry in own_state(program):
        width = widths[signal_of(entry).kind]
        if is_ring(entry):
            yield width * entry.length, width
            yield _POSITION, _POSITION
        else:
            yield width, width
    for call in instances(program):
        yield _extent(call.program, precision)
