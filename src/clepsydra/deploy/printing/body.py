"""The statements of a program in any language, over the variables that its interface declares."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import Expression, reading, variable
from clepsydra.deploy.printing.folding import FoldedBlock, Scope
from clepsydra.deploy.printing.heading import harmless
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.listing import (
    Assignment,
    BlockCall,
    Compound,
    ListingStatement,
    Repeated,
    touched,
)
from clepsydra.deploy.printing.statements import Language, ring_place
from clepsydra.deploy.printing.whole_numbers import whole_ranges
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import owned_by_calls
from clepsydra.program.precision import largest_number
from clepsydra.program.program import Program

#: A line of words above a step is no wider than this [characters].
_WIDTH = 90


def places_of(program: Program, mark: str = "") -> dict[str, list[str]]:
    """Return what reads and writes the signals of a program, by their groups and in their order.

    Parameters
    ----------
    program : Program
    mark : str
        What stands between the name of a group and that of a signal, where a group is a structure.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (), (Signal("tank.level"),), (), (Signal("y"),), Block(1, (), (0,)))
    >>> places_of(law)["inputs"], places_of(law, "->")["outputs"]
    (['tank_level'], ['outputs->y'])
    """
    groups = ("state", "inputs", "parameters", "outputs")
    before = {group: f"{group}{mark}" if mark else "" for group in groups}
    return {
        group: [f"{before[group]}{signal_of(each).identifier}" for each in getattr(program, group)]
        for group in groups
    }


class Body:
    """The statements of a program.

    Parameters
    ----------
    program : Program
        In its printed form.
    language : Language
    names : Identifiers
        The scope of the statements, with all that stands there already.
    places : mapping
        See `places_of`.

    Examples
    --------
    >>> from clepsydra.deploy.c99.statements import C99
    >>> from clepsydra.program.program import Block, Operation
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> names, places = Identifiers([], ignore_case=False), places_of(program)
    >>> Body(program, C99("law", "double"), names, places).lines
    ['y = x + x;']
    """

    def __init__(
        self,
        program: Program,
        language: Language,
        names: Identifiers,
        places: Mapping[str, Sequence[str]],
    ) -> None:
        self._program, self._names, self._places = program, names, places
        self._made, self._uses = program.block.made, program.block.uses()
        meant = (*program.constants, largest_number(language.precision))
        constants = {names.new(each.identifier): each for each in meant}
        language = self._language = language.naming(constants)
        owned, state = owned_by_calls(program), places["state"]
        rings = [entry.length if is_ring(entry) else 0 for entry in program.state]
        held = zip(count(), program.given, state, rings)
        #: The states that no instance holds: value, signal, where it stands, length of a ring.
        self._held = [each for each in held if each[0] not in owned]
        ranges = whole_ranges(program, language.precision)
        labels, preferred = self._labels()
        at = [*map(ring_place, state, rings), *places["inputs"], *places["parameters"]]
        given = [reading(each.kind, place) for each, place in zip(program.given, at, strict=True)]
        scope = Scope(language, names, program.tables)
        kinds = {place: signal.kind for _, signal, place, _ in self._held}
        outputs = zip(places["outputs"], program.outputs, strict=True)
        kinds |= {place: signal.kind for place, signal in outputs}
        folded = FoldedBlock(program.block, given, scope, labels, preferred, ranges, kinds)
        #: Tables of the loops by name.
        self.tables, results = scope.tables, folded.results
        #: Arrays that routines keep numbers in, by name.
        self.arrays = scope.arrays
        self._statements = folded.statements
        kept = zip(self._held, self._kept(results), strict=True)
        stores = [Assignment(ring_place(p, n), self._plain(s, r)) for (_, s, p, n), r in kept]
        told = zip(program.outputs, places["outputs"], results[len(program.state) :], strict=True)
        shown = [Assignment(place, self._plain(output, result)) for output, place, result in told]
        moves = [*_whole(shown, program), *stores]
        if language.told:
            moves = self._told_at_calls(moves)
        moves = [each for each in moves if each.expression.text != each.name]
        lines = language.statements([*self._statements, *moves], self._words(labels))
        lines += (language.moved_on(place, length) for _, _, place, length in self._held if length)
        known = {*places["outputs"], *places["state"]}
        found = {name: kind for name, kind in _declared(self._statements) if name not in known}
        names_read = {*re.findall(r"\w+", "\n".join(lines))}
        #: Constants that the statements read, by name.
        self.constants = {n: each for n, each in constants.items() if n in names_read}
        #: Name and type of the variables that are no part of the interface.
        self.temporaries = {name: language.types[kind] for name, kind in found.items()}
        #: The statements, each on one line however long.
        self.lines = lines

    def _words(self, labels: Mapping[int, str]) -> dict[str, list[str]]:
        """Return the comments above the steps, by what these assign."""
        program, comment = self._program, self._language.comment.format
        named = {labels[v]: name for v, name in program.names.items() if v in labels}
        for group in ("state", "outputs"):
            names = (entry.name for entry in getattr(program, group))
            named |= dict(zip(self._places[group], names, strict=True))
        return {
            place: [comment(r) for r in textwrap.wrap(harmless(program.words[name]), _WIDTH)]
            for place, name in named.items()
            if name in program.words
        }

    def _labels(self) -> tuple[dict[int, str], dict[int, str]]:
        """Return the names of values that have one: the law's own, outputs, next states."""
        program, first = self._program, self._program.block.arguments
        instances = {call.identifier for call in program.calls}
        labels = self._begun()
        results = dict(zip(program.output_values, program.outputs, strict=True))
        for place, value in zip(self._places["outputs"], program.output_values, strict=True):
            # An output variable may be read back: the value needs no other name.
            made = self._made.get(value)
            if made and made.code == "number":
                value = made.arguments[0]
            if value >= first:
                labels.setdefault(value, place)
        scaled = self._scaled_for_a_call()
        for value, name in program.names.items():
            if value in scaled and name not in program.words:
                continue
            own = value in results and results[value].name == name
            if value >= first and value in self._uses and value not in labels and not own:
                clashes = name.replace(".", "_") in instances
                labels[value] = self._names.new(f"{name}_value" if clashes else name)
        preferred = {
            value: f"next_{signal_of(entry).identifier}"
            for entry, value in zip(program.state, program.next_state, strict=True)
        }
        return labels, preferred

    def _scaled_for_a_call(self) -> set[int]:
        """Return what is given, in another unit, to ports alone: these name it."""
        program, made = self._program, self._made
        given = Counter(value for call in program.calls for value in call.arguments)
        codes = {1: ("multiply", "divide", "select"), 2: ("multiply", "divide")}
        return {
            value
            for value, ports in given.items()
            if self._uses[value] == ports
            and value in made
            and made[value].code in codes.get(ports, ())
            and min(made[value].arguments) < program.block.arguments
        }

    def _begun(self) -> dict[int, str]:
        """Return the values that a state is set to where it begins anew, before it is read."""
        made, uses = self._made, self._uses
        held = {value: place for value, _, place, ring in self._held if not ring}
        labels: dict[int, str] = {}
        for target, each in made.items():
            given = each.arguments
            if each.code == "select" and given[2] in held and uses[given[2]] == 1:
                labels[target] = held[target] = held[given[2]]
        return labels

    def _kept(self, results: Sequence[Expression]) -> list[Expression]:
        """Give the next values variables where a state that they read is overwritten before."""
        kept = []
        overwritten: set[str] = set()
        for value, signal, place, length in self._held:
            result = results[value]
            if overwritten & touched(Assignment("", result)):
                name = self._names.new(f"next_{signal.identifier}")
                self._statements.append(Assignment(name, self._plain(signal, result)))
                result = reading(signal.kind, name)
            kept.append(result)
            overwritten.add(ring_place(place, length))
        return kept

    def _told_at_calls(self, moves: list[Assignment]) -> list[Assignment]:
        """Return moves without what calls can hand over, since nothing touches it later."""
        at = {f"{each.instance}.": k for k, each in enumerate(self._statements)
              if isinstance(each, BlockCall)}  # fmt: skip
        for each in [*moves]:
            instance, _, port = each.expression.text.rpartition(".")
            k = at.get(f"{instance}.", -1)
            later = [*self._statements[k + 1 :], *(other for other in moves if other != each)]
            if k < 0 or each.name.endswith("]") or any(each.name in touched(s) for s in later):
                continue
            call = self._statements[k]
            assert isinstance(call, BlockCall)
            if port not in dict(call.told):
                self._statements[k] = replace(call, told=(*call.told, (port, each.name)))
                moves.remove(each)
        return moves

    def _plain(self, signal: Signal, result: Expression) -> Expression:
        """Return a result in the type of its signal."""
        computed = result.known_as(signal.kind) is None
        if computed and not self._language.writes(result):
            name = self._names.new(f"{signal.identifier}_number")
            self._statements.append(Assignment(name, result))
            result = variable(name)
        return result.to(signal.kind)


def _whole(shown: Sequence[Assignment], program: Program) -> list[Assignment]:
    """Return assignments of outputs, with one for a structure that is copied and then changed."""
    outputs = ((call.identifier, told) for call in program.calls for told in call.program.outputs)
    told = {f"{at}.{each.identifier}": (f"{at}.{each.variable}", each) for at, each in outputs}
    held: dict[str, list[tuple[str, Assignment]]] = {}
    for output, each in zip(program.outputs, shown, strict=True):
        whole = each.name.removesuffix(f".{output.part}") if output.record else each.name
        source, signal = told.get(each.expression.text, ("", output))
        alike = output.record and (signal.record, signal.part) == (output.record, output.part)
        held.setdefault(whole, []).append((source if alike else "", each))
    found = []
    for name, members in held.items():
        sources = {source for source, _ in members if source}
        others = [each for source, each in members if not source]
        # A member that stands there already would be lost.
        if len(sources) == 1 and all(each.expression.text != each.name for each in others):
            found += [Assignment(name, variable(sources.pop())), *others]
        else:
            found += [each for _, each in members]
    return found


def _declared(statements: Sequence[ListingStatement]) -> list[tuple[str, str]]:
    """Return every variable that statements assign and the kind of what it holds, in order."""
    found: list[tuple[str, str]] = []
    for entry in statements:
        if isinstance(entry, Assignment):
            # An element belongs to an array, which is declared as a whole.
            found += [] if entry.name.endswith("]") else [(entry.name, entry.expression.kind)]
        elif isinstance(entry, Repeated):
            found += [(entry.index, "integer"), *_declared(entry.body)]
        elif isinstance(entry, Compound):
            found += [(entry.index, "integer")] if len(entry.turns) > 1 else []
            found += [(turn.oldest, "real") for turn in entry.rings if turn.oldest]
            found += _declared(entry.start) + _declared(entry.body)
    return found
