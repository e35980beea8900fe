"""The statements of a program in any language, over the variables that its interface declares."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass

from clepsydra.base.signal import Signal
from clepsydra.deploy.printing.expressions import Expression, flag, integer, variable
from clepsydra.deploy.printing.folding import list_block
from clepsydra.deploy.printing.identifiers import Identifiers
from clepsydra.deploy.printing.in_place import in_place, mentions
from clepsydra.deploy.printing.language import Language
from clepsydra.deploy.printing.listing import (
    Assignment,
    Branch,
    CountedLoop,
    ListingStatement,
    touched,
)
from clepsydra.deploy.printing.statements import advance, ring_place, statements
from clepsydra.deploy.printing.typed_values import of_kind
from clepsydra.deploy.printing.whole_numbers import whole_ranges
from clepsydra.program.entries import is_ring, signal_of
from clepsydra.program.owned_state import owned_by_calls
from clepsydra.program.program import Operation, Program


@dataclass(frozen=True)
class Places:
    """What reads and writes the signals of a program, in their order.

    Examples
    --------
    >>> from clepsydra.program.program import Block
    >>> law = Program("law", (), (Signal("tank.level"),), (), (Signal("y"),), Block(1, (), (0,)))
    >>> Places.of(law, inputs="inputs->").inputs
    ['inputs->tank_level']
    """

    state: list[str]
    inputs: list[str]
    parameters: list[str]
    outputs: list[str]

    @classmethod
    def of(cls, program: Program, **prefixes: str) -> Places:
        """Return the identifiers of a program's signals, those of a group behind its prefix."""

        def named(group: str) -> list[str]:
            entries, prefix = getattr(program, group), prefixes.get(group, "")
            return [prefix + signal_of(each).identifier for each in entries]

        return cls(*map(named, ("state", "inputs", "parameters", "outputs")))


class Body:
    """The statements of a program.

    Parameters
    ----------
    program : Program
        In its printed form.
    language : Language
    names : Identifiers
        The scope of the statements, with all that stands there already.
    places : Places

    Examples
    --------
    >>> from clepsydra.deploy.c99.language import C99
    >>> from clepsydra.program.program import Block
    >>> double = Block(1, (Operation(1, "add", (0, 0)),), (1,))
    >>> program = Program("double_it", (), (Signal("x"),), (), (Signal("y"),), double)
    >>> names = Identifiers([], ignore_case=False)
    >>> places = Places.of(program, outputs="outputs->")
    >>> Body(program, C99("law", "double"), names, places).lines()
    ['outputs->y = x + x;']
    """

    def __init__(
        self, program: Program, language: Language, names: Identifiers, places: Places
    ) -> None:
        self._program, self._language, self._names = program, language, names
        self._places = places
        owned = owned_by_calls(program)
        #: The states that no instance holds, by where they stand.
        self._held = {
            place: entry
            for k, (place, entry) in enumerate(zip(places.state, program.state, strict=True))
            if k not in owned
        }
        ranges = whole_ranges(program, "single" if language.notation.single else "double")
        made = {each.target for each in program.block.statements if isinstance(each, Operation)}
        # What is whole may have a variable of another type than a number.
        labels, preferred = self._labels(made.intersection(ranges))
        listing = list_block(
            program.block,
            list(self._arguments()),
            language.notation,
            names,
            labels=labels,
            preferred=preferred,
            read=self._read,
            ranges=ranges,
        )
        #: Tables of the loops by name.
        self.tables = listing.tables
        self._statements = _together([*map(_begun, listing.statements)], self._held)
        count = len(program.state)
        following = [each for k, each in enumerate(listing.results[:count]) if k not in owned]
        self._next = [
            self._plain(signal_of(entry), result)
            for entry, result in zip(self._held.values(), self._kept(following), strict=True)
        ]
        self._outputs = [
            self._plain(output, result)
            for output, result in zip(program.outputs, listing.results[count:], strict=True)
        ]
        self._lines = in_place(self._written(), self._found(), self._assigned())

    def lines(self) -> list[str]:
        """Return the lines of the statements, each statement on one line however long."""
        return self._lines

    def temporaries(self) -> dict[str, str]:
        """Return name and type of the variables that are no part of the interface."""
        types = self._language.types
        return {
            name: types[kind]
            for name, kind in self._found().items()
            if any(mentions(line, name) for line in self._lines)
        }

    def _found(self) -> dict[str, str]:
        known = {*self._places.outputs, *self._places.state}
        return {n: kind for n, kind in _declared(self._statements) if n not in known}

    def _assigned(self) -> list[str]:
        """Return what results go to."""
        states = [place for place, entry in self._held.items() if not is_ring(entry)]
        return [*self._places.outputs, *states]

    def _written(self) -> list[str]:
        language = self._language
        shown = [
            Assignment(place, result)
            for place, result in zip(self._places.outputs, self._outputs, strict=True)
            if result.text != place
        ]
        stores: list[Assignment] = []
        rings: list[str] = []
        for (place, entry), result in zip(self._held.items(), self._next, strict=True):
            if is_ring(entry):
                rings += statements([Assignment(ring_place(place), result)], language)
                rings += advance(place, entry.length, language)
            elif result.text != place:
                stores.append(Assignment(place, result))
        lines = statements(self._statements, language)
        stored = [*statements(stores, language), *rings]
        for title, results in (("outputs", statements(shown, language)), ("next state", stored)):
            lines += [language.syntax.comment.format(title), *results] if results else []
        return lines

    def _arguments(self) -> Iterator[Expression]:
        for entry, place in zip(self._program.state, self._places.state, strict=True):
            yield self._read(signal_of(entry), ring_place(place, is_ring(entry)))
        signals = (*self._program.inputs, *self._program.parameters)
        for signal, place in zip(
            signals, (*self._places.inputs, *self._places.parameters), strict=True
        ):
            yield self._read(signal, place)

    def _read(self, signal: Signal, name: str) -> Expression:
        """Return what reads a variable that is declared with the type of a signal."""
        if signal.kind == "boolean":
            return Expression("number", (flag(name),))
        return integer(name) if signal.kind == "integer" else variable(name)

    def _labels(self, whole: Container[int]) -> tuple[dict[int, str], dict[int, str]]:
        """Return the names of values that have one: the law's own, outputs, next states."""
        program, used = self._program, self._program.block.uses()
        first = program.block.arguments
        instances = {call.identifier for call in program.calls}
        labels = self._begun()
        preferred: dict[int, str] = {}
        for output, place, value in zip(
            program.outputs, self._places.outputs, program.output_values, strict=True
        ):
            # An output variable may be read back: the value needs no other name.
            unnamed = program.names.get(value, output.name) == output.name
            if output.kind == "real" and value >= first and unnamed and value not in whole:
                labels.setdefault(value, place)
        results = dict(zip(program.output_values, program.outputs, strict=True))
        for value, name in program.names.items():
            own = value in results and results[value].name == name
            if value >= first and value in used and value not in labels and not own:
                clashes = name.replace(".", "_") in instances
                labels[value] = self._names.new(f"{name}_value" if clashes else name)
        for entry, value in zip(program.state, program.next_state, strict=True):
            if value not in labels and value not in results:
                preferred[value] = f"next_{signal_of(entry).identifier}"
        return labels, preferred

    def _begun(self) -> dict[int, str]:
        """Return the values that a state is set to where it begins anew, before it is read."""
        program, uses = self._program, self._program.block.uses()
        entries = (*program.state, *program.inputs, *program.parameters)
        constants = {
            each.target
            for each in program.block.statements
            if isinstance(each, Operation) and each.code == "constant"
        }
        held = {
            value: (place, signal_of(self._held[place]).kind)
            for value, place in enumerate(self._places.state)
            if place in self._held and not is_ring(self._held[place])
        }
        labels: dict[int, str] = {}
        truths: dict[int, int] = {}
        negated: set[int] = set()
        for each in program.block.statements:
            if not isinstance(each, Operation):
                continue
            if each.code == "truth" and uses[each.arguments[0]] == 1:
                truths[each.target] = each.arguments[0]
            if each.code == "not":
                negated.add(each.target)
            if each.code == "and" and negated.intersection(each.arguments):
                for value in each.arguments:
                    if uses[value] == 1 and truths.get(value) in held:
                        labels[each.target] = held[truths[value]][0]
            if each.code != "select":
                continue
            _, start, before = each.arguments
            if before not in held or uses[before] != 1:
                continue
            place, kind = held[before]
            given = start in constants or (
                start < len(entries) and signal_of(entries[start]).kind == kind
            )
            if given or kind == "real":
                labels[each.target] = place
                held[each.target] = held[before]
        return labels

    def _kept(self, results: Sequence[Expression]) -> list[Expression]:
        """Give the next values variables where a state that they read is overwritten before."""
        kept = []
        overwritten: set[str] = set()
        for (place, entry), result in zip(self._held.items(), results, strict=True):
            signal = signal_of(entry)
            if overwritten & touched(Assignment("", result)):
                result = self._variable(f"next_{signal.identifier}", signal, result)
            kept.append(result)
            overwritten.add(ring_place(place, is_ring(entry)))
        return kept

    def _plain(self, signal: Signal, result: Expression) -> Expression:
        """Return a result in the type of its signal."""
        found = of_kind(signal.kind, result)
        if found.code in ("rounded", "truth") and not self._language.notation.writes(result):
            name = self._names.new(f"{signal.identifier}_number")
            self._statements.append(Assignment(name, result))
            return of_kind(signal.kind, variable(name))
        return found

    def _variable(self, wanted: str, signal: Signal, result: Expression) -> Expression:
        name = self._names.new(wanted)
        self._statements.append(Assignment(name, self._plain(signal, result)))
        return self._read(signal, name)


def _begun(statement: ListingStatement) -> ListingStatement:
    """Return ``x := x AND NOT c`` as what sets x to FALSE where c holds."""
    if not isinstance(statement, Assignment) or statement.expression.code != "and":
        return statement
    kept = flag(statement.name)
    others = [each for each in statement.expression.operands if each != kept]
    if len(others) != 1 or others[0].code != "not":
        return statement
    chosen = Expression("select", (others[0].operands[0], flag("FALSE"), kept))
    return Assignment(statement.name, chosen)


def _together(
    statements: Sequence[ListingStatement], held: Container[str]
) -> list[ListingStatement]:
    """Return statements with those beside each other that let states begin anew alike.

    Such a statement comes earlier where nothing before it has touched its state.
    """
    found: list[ListingStatement] = []
    for each in statements:
        place = len(found)
        begins = _beginning(each, held)
        if isinstance(each, Assignment) and begins is not None:
            places = [k for k, other in enumerate(found) if _beginning(other, held) == begins]
            early = places[-1] + 1 if places else place
            place = place if any(each.name in touched(s) for s in found[early:]) else early
        found.insert(place, each)
    return found


def _beginning(statement: ListingStatement, held: Container[str]) -> Expression | None:
    """Return the condition under which a statement sets a state to a constant."""
    if not isinstance(statement, Assignment) or statement.expression.code != "select":
        return None
    condition, start, kept = statement.expression.operands
    constant = start.code in ("constant", "whole") or start.text in ("TRUE", "FALSE")
    kept_alike = kept.text == statement.name and statement.name in held
    return condition if constant and kept_alike else None


def _declared(statements: Sequence[ListingStatement]) -> list[tuple[str, str]]:
    """Return every variable that statements assign and the kind of what it holds, in order."""
    found: list[tuple[str, str]] = []
    for entry in statements:
        if isinstance(entry, Assignment):
            truth, whole = entry.expression.is_truth, entry.expression.is_whole
            found.append((entry.name, "boolean" if truth else "integer" if whole else "real"))
            continue
        if isinstance(entry, CountedLoop):
            found += [(entry.index, "integer")] if entry.count > 1 else []
            found += [(turn.oldest, "real") for turn in entry.rings if turn.oldest]
        if isinstance(entry, (CountedLoop, Branch)):
            found += _declared(entry.start) + _declared(entry.body)
    return found
