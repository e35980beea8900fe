"""Prints the statements of a block as LLVM code."""

from __future__ import annotations

from clepsydra.engine.elementary_functions import elementary_function
from clepsydra.engine.vector_rings import RingPrinter
from clepsydra.engine.vector_text import VectorText
from clepsydra.program.program import LIBRARY, Block, Conditional, Loop, Operation, Statement

_ARITHMETIC = {
    "add": "fadd",
    "subtract": "fsub",
    "multiply": "fmul",
    "divide": "fdiv",
}
_COMPARE = {
    "less": "olt",
    "less_equal": "ole",
    "equal": "oeq",
    "not_equal": "une",
}
_INTRINSIC = {
    "square_root": "sqrt",
    "absolute": "fabs",
    "floor": "floor",
    "ceiling": "ceil",
}


class StatementPrinter:
    """Prints the statements of one block; `values` maps value numbers to LLVM names."""

    def __init__(
        self,
        text: VectorText,
        block: Block,
        values: dict[int, str],
        *,
        fuse: bool,
        rings: RingPrinter,
    ) -> None:
        self.text = text
        self.values = values
        self.fuse = fuse
        self.rings = rings
        self.products = _single_products(block) if fuse else {}

    def statement(self, statement: Statement) -> None:
        """Print a statement and remember the names of its results."""
        if isinstance(statement, Loop):
            self._loop(statement)
        elif isinstance(statement, Conditional):
            self._conditional(statement)
        else:
            self.values[statement.target] = self._operation(statement)

    def _body(self, body: Block, arguments: list[str]) -> list[str]:
        """Print the statements of a body and return the names of its results."""
        inner = dict(enumerate(arguments))
        printer = StatementPrinter(self.text, body, inner, fuse=self.fuse, rings=self.rings)
        for statement in body.statements:
            printer.statement(statement)
        return [inner[result] for result in body.results]

    def _conditional(self, conditional: Conditional) -> None:
        """Branch around the body where no lane needs it, and select lane by lane behind it."""
        text, before = self.text, self.text.label
        label = text.new_label("when")
        condition = self.values[conditional.condition]
        carried = [self.values[value] for value in conditional.carried]
        needed = self._any(condition)
        text.line(f"br i1 {needed}, label %{label}, label %{label}.done")
        text.begin(label)
        results = self._body(
            conditional.body, carried + [self.values[value] for value in conditional.invariants]
        )
        if text.lanes > 1:
            results = [
                self._select(condition, result, start)
                for result, start in zip(results, carried, strict=True)
            ]
        inside = text.label
        text.line(f"br label %{label}.done")
        text.begin(f"{label}.done")
        for target, start, result in zip(conditional.targets, carried, results, strict=True):
            self.values[target] = text.assign(
                f"phi {text.real} [ {start}, %{before} ], [ {result}, %{inside} ]"
            )

    def _operation(self, operation: Operation) -> str:
        text, code = self.text, operation.code
        if code == "constant":
            return text.literal(operation.constant)
        fused = self._fused(operation)
        if fused is not None:
            return fused
        given = [self.values[argument] for argument in operation.arguments]
        if code in _ARITHMETIC:
            return text.assign(f"{_ARITHMETIC[code]} {text.real} {given[0]}, {given[1]}")
        if code in _COMPARE:
            return self._compare(_COMPARE[code], given)
        if code == "negate":
            return text.assign(f"fneg {text.real} {given[0]}")
        if code in _INTRINSIC:
            return text.intrinsic(_INTRINSIC[code], given)
        if code in ("minimum", "maximum"):
            condition = self._compare("olt" if code == "minimum" else "ogt", given)
            return self._select(condition, given[0], given[1])
        if code == "select":
            return self._select(*given)
        if code == "number":
            return self._select(given[0], text.literal(1.0), text.literal(0.0))
        if code == "truth":
            return self._compare("une", [given[0], text.literal(0.0)])
        if code == "not":
            return text.assign(f"xor {text.truth} {given[0]}, {text.all_true()}")
        if code in ("and", "or"):
            return text.assign(f"{code} {text.truth} {given[0]}, {given[1]}")
        if code in LIBRARY:
            return elementary_function(text, code, given)
        raise ValueError(f"the engine has no form for operation {code!r}")

    def _compare(self, predicate: str, given: list[str]) -> str:
        text = self.text
        return text.assign(f"fcmp {predicate} {text.real} {given[0]}, {given[1]}")

    def _select(self, condition: str, first: str, second: str) -> str:
        text = self.text
        return text.assign(
            f"select {text.truth} {condition}, {text.real} {first}, {text.real} {second}"
        )

    def _fused(self, operation: Operation) -> str | None:
        """Print a·b ± c as one fused multiply-add where the law allows it."""
        if not operation.fused or operation.code not in ("add", "subtract"):
            return None
        left, right = operation.arguments
        minus = operation.code == "subtract"
        if left in self.products:
            one, two = (self.values[v] for v in self.products[left])
            rest = self.values[right]
            if minus:
                rest = self.text.assign(f"fneg {self.text.real} {rest}")
            return self.text.intrinsic("fma", [one, two, rest])
        if right in self.products:
            one, two = (self.values[v] for v in self.products[right])
            if minus:
                one = self.text.assign(f"fneg {self.text.real} {one}")
            return self.text.intrinsic("fma", [one, two, self.values[left]])
        return None

    def _any(self, condition: str) -> str:
        """Return whether a truth value is true in any lane."""
        text = self.text
        if text.lanes == 1:
            return condition
        together = text.assign(f"bitcast {text.truth} {condition} to i{text.lanes}")
        return text.assign(f"icmp ne i{text.lanes} {together}, 0")

    def _loop(self, loop: Loop) -> None:
        text = self.text
        label = text.new_label("loop")
        before = text.label
        text.line(f"br label %{label}")
        text.begin(label)
        text.line(f"%{label}.i = phi i64 [ 0, %{before} ], [ %{label}.next, %{label}.end ]")
        carried = [f"%{label}.c{i}" for i in range(len(loop.carried))]
        gaps = [text.gap() for _ in carried]
        rings = [self.rings.number(ring) for ring in loop.rings]
        for ring in (f"%ring{number}" for number in rings):
            text.line(f"{ring}.turn = phi i64 [ {ring}, %{before} ], [ {ring}.next, %{label}.end ]")
        rows = []
        for number, table in enumerate(loop.tables):
            symbol = f"@{label}.table{number}"
            text.table(symbol, table)
            rows.append(text.load_spread(symbol, f"%{label}.i"))
        places = [self.rings.place(number, f"%ring{number}.turn") for number in rings]
        invariants = [self.values[value] for value in loop.invariants]
        results = self._body(loop.body, rows + carried + list(map(text.load, places)) + invariants)
        written = results[len(carried) :]
        for value, place in zip(written, places, strict=True):
            text.store(value, place)
        text.line(f"br label %{label}.end")
        text.begin(f"{label}.end")
        for number in rings:
            self.rings.advance(number, f"%ring{number}.turn")
        text.line(f"%{label}.next = add i64 %{label}.i, 1")
        text.line(f"%{label}.more = icmp slt i64 %{label}.next, {loop.count}")
        text.line(f"br i1 %{label}.more, label %{label}, label %{label}.done")
        following = results[: len(carried)]
        for gap, name, start, result in zip(gaps, carried, loop.carried, following, strict=True):
            text.fill(
                gap,
                f"{name} = phi {text.real} [ {self.values[start]}, %{before} ], "
                f"[ {result}, %{label}.end ]",
            )
        text.begin(f"{label}.done")
        self.values.update(zip(loop.targets, following, strict=True))


def _single_products(block: Block) -> dict[int, tuple[int, ...]]:
    """Return the fusible products that are read exactly once, with their factors."""
    uses = block.uses()
    return {
        statement.target: statement.arguments
        for statement in block.statements
        if isinstance(statement, Operation)
        and statement.code == "multiply"
        and statement.fused
        and uses.get(statement.target) == 1
    }
