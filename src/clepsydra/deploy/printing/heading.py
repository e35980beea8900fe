"""The comments of a printed program: what it is, which text it came from, what a name means."""

from __future__ import annotations

import hashlib
import textwrap
from collections.abc import Iterable, Iterator, Sequence

import casadi as ca

from clepsydra import __version__
from clepsydra.base.signal import Signal
from clepsydra.controllers.signals import LARGEST_PARAMETER
from clepsydra.deploy.printing.origin import Origin
from clepsydra.program.delay_ring import DelayRing
from clepsydra.program.entries import Entry, signal_of
from clepsydra.program.program import Program
from clepsydra.program.renumbered import renumbered

#: A line of a head comment is no wider than this [characters].
_WIDTH = 90
_CONSTANTS = (
    "Numbers inside formulas belong to the equations of the law, in the SI units of its signals; "
    "all others have their unit, and their source where it is known, in a comment."
)


def digest(program: Program) -> str:
    """Return a short digest of a program: signals, words, values, names and every operation.

    One version of Clepsydra prints programs with the same digest as the same statements, so they
    also compute the same numbers from the same start. Versions of CasADi simplify by rules of
    their own: single loops are read alike by 3.7.0 and 3.8.2; decoupling, schemes of loops, fuzzy
    rules and models inside a law are not, so `written_with` stands beside the digest.

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("law", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> named = Program("law", (), (Signal("x"),), (), (Signal("y"),), double, {1: "twice"})
    >>> len(digest(program)), digest(program) == digest(named)
    (16, False)
    """
    return hashlib.sha256(repr(renumbered(program)).encode()).hexdigest()[:16]


def written_with() -> str:
    """Return what decides, beside the law, which statements are printed: both with their version.

    Examples
    --------
    >>> written_with().split()[::3]
    ['Clepsydra', 'CasADi']
    """
    return f"Clepsydra {__version__} with CasADi {ca.CasadiMeta.version()}"


def heading(
    program: Program, language: str, notes: tuple[str, ...], origin: Origin | None = None
) -> list[str]:
    """Return the lines of the head comment.

    Parameters
    ----------
    program : Program
        As it is printed: its digest is that of the numbers in the text.
    language : str
    notes : tuple of str
        What the language's reader must know.
    origin : Origin, optional

    Examples
    --------
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> heading(program, "C99", ())[0]
    'double_it: one sample of a step law, in C99.'
    """
    return [
        f"{program.name}: one sample of a step law, in {language}.",
        f"Printed by {written_with()}; program digest {digest(program)}.",
        *_wrapped(origin.lines() if origin else ()),
        "Do not edit: print it again from the law instead.",
        *notes,
        *_wrapped([_CONSTANTS]),
    ]


def _wrapped(lines: Iterable[str]) -> Iterator[str]:
    for line in lines:
        yield from textwrap.wrap(harmless(line), _WIDTH, subsequent_indent="  ")


def comment(entry: Entry, *, source: str = "", counted: str = "sample") -> str:
    """Return unit, range and description of a signal for a comment, and its number's source.

    Parameters
    ----------
    entry : Signal or DelayRing
    source : str
        Where its number comes from.
    counted : str
        What a delay counts.

    Examples
    --------
    >>> level = Signal("level", "m", low=0.0, high=0.2, description="level of tank 1")
    >>> comment(level), comment(level, source="operating point")
    ('[m] 0 to 0.2; level of tank 1', '[m] 0 to 0.2; level of tank 1; operating point')
    """
    signal = signal_of(entry)
    parts = [] if signal.kind == "boolean" else [f"[{signal.unit}]{_bounds(signal)}"]
    if isinstance(entry, DelayRing):
        parts.append(f"delayed by {entry.length} {counted}{'s' if entry.length > 1 else ''}")
    if signal.description:
        parts.append(signal.description)
    return harmless("; ".join([*(parts or ["truth value"]), *([source] if source else [])]))


def number_comment(entry: Entry, source: str = "") -> str:
    """Return unit and source of a number, for a comment beside it.

    Examples
    --------
    >>> number_comment(Signal("level.integral_time", "s"), "SIMC rules")
    '[s] SIMC rules'
    """
    signal = signal_of(entry)
    truth = signal.kind == "boolean"
    unit, between = ("truth value", "; ") if truth else (f"[{signal.unit}]", " ")
    return harmless(f"{unit}{between}{source}" if source else unit)


def table_comment(origin: Origin | None) -> str:
    """Return what a comment says of a table of a loop.

    Examples
    --------
    >>> table_comment(None)
    'numbers of the equations of the law, one for each turn of a loop'
    """
    source = f"; {origin.default_source}" if origin and origin.default_source else ""
    return harmless(f"numbers of the equations of the law, one for each turn of a loop{source}")


def _bounds(signal: Signal) -> str:
    # The bound that a parameter has so that it is a reasonable number tells its reader nothing.
    low = f"{signal.low:.12g}" if signal.low > -LARGEST_PARAMETER else ""
    high = f"{signal.high:.12g}" if signal.high < LARGEST_PARAMETER else ""
    if low and high:
        return f" {low} to {high}"
    return f" from {low}" if low else f" up to {high}" if high else ""


def commented(line: str, text: str, opening: str, closing: str, width: int) -> list[str]:
    """Return a line with its comment, if any, behind it, or above it where both are too wide.

    Examples
    --------
    >>> commented("x : LREAL;", "[m] level of the tank", "(*", "*)", 24)
    ['(* [m] level of the', '   tank *)', 'x : LREAL;']
    """
    together = f"{line} {opening} {text} {closing}"
    if not text or len(together) <= width:
        return [together if text else line]
    # The closing mark stays with the last word.
    whole = f"{opening} {text}\N{NO-BREAK SPACE}{closing}"
    above = textwrap.wrap(whole, width, subsequent_indent=" " * (len(opening) + 1))
    return [*(row.replace("\N{NO-BREAK SPACE}", " ") for row in above), line]


def enclosed(rows: Sequence[str], opening: str, closing: str) -> list[str]:
    """Return rows of text as one comment.

    Examples
    --------
    >>> enclosed(["One.", "Two."], "(*", "*)")
    ['(* One.', '   Two. *)']
    """
    first, *rest = rows
    found = [f"{opening} {first}", *(f"{' ' * len(opening)} {row}" for row in rest)]
    return [*found[:-1], f"{found[-1]} {closing}"]


def harmless(text: str) -> str:
    """Return a text on one line that neither opens nor closes a comment.

    Examples
    --------
    >>> harmless("level */ of\\ntank (* 1")
    'level * / of tank ( * 1'
    """
    text = " ".join(text.split())
    for mark in ("/*", "*/", "(*", "*)"):
        text = text.replace(mark, f"{mark[0]} {mark[1]}")
    return text
