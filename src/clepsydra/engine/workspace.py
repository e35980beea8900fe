"""Values of a large kernel that live in memory: where each stands, and how it is moved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from clepsydra.engine.vector_text import VectorText

#: The name of the pointer to the memory, in every function that uses it.
POINTER = "%workspace"
#: Memory that a vector of any width may be read from in one access [bytes].
_ALIGNMENT = 64


class Workspace:
    """Rows of memory, one vector each, that are taken and given back while code is printed.

    Examples
    --------
    >>> workspace = Workspace()
    >>> first, second = workspace.take(), workspace.take()
    >>> workspace.give(first)
    >>> workspace.take() == first, workspace.rows
    (True, 2)
    """

    def __init__(self) -> None:
        self.rows = 0
        self._free: list[int] = []

    def take(self) -> int:
        """Return a row that nothing else uses."""
        if self._free:
            return self._free.pop()
        self.rows += 1
        return self.rows - 1

    def take_together(self, count: int) -> range:
        """Return rows one behind the other, which are copied at once."""
        self.rows += count
        return range(self.rows - count, self.rows)

    def give(self, row: int) -> None:
        """Let others use a row."""
        self._free.append(row)

    def begin(self, text: VectorText) -> int:
        """Print how a kernel gets its memory; return the gap for its size, see `end`.

        The heap is used because the stack of a thread may be smaller than this.
        """
        text.declarations |= {"declare ptr @malloc(i64)", "declare void @abort() #1"}
        size = text.gap()
        text.line("%memory = call ptr @malloc(i64 %memory.size) #1")
        text.line("%memory.none = icmp eq ptr %memory, null")
        text.line("br i1 %memory.none, label %memory.fail, label %memory.there")
        text.begin("memory.fail")
        text.line("call void @abort() #1")
        text.line("unreachable")
        text.begin("memory.there")
        text.line("%memory.place = ptrtoint ptr %memory to i64")
        text.line("%memory.below = sub i64 0, %memory.place")
        text.line(f"%memory.shift = and i64 %memory.below, {_ALIGNMENT - 1}")
        text.line(f"{POINTER} = getelementptr i8, ptr %memory, i64 %memory.shift")
        return size

    def end(self, text: VectorText, size: int) -> None:
        """Print how a kernel gives its memory back, once all rows are known."""
        text.declarations.add("declare void @free(ptr)")
        text.fill(size, f"%memory.size = add i64 0, {8 * text.lanes * self.rows + _ALIGNMENT}")
        text.line("call void @free(ptr %memory) #1")


class StoredValues(dict[int, str]):
    """The values of a block by number, as code that stands between its parts sees them.

    To read an entry is to print a load from its row and get the name of what is loaded; to
    assign one is to print a store. A constant is its literal. What has no row is read by nobody
    and not stored.

    Parameters
    ----------
    text : VectorText
        Where loads and stores are printed.
    workspace : Workspace
    truths : collection of int
        The values that are truth values; they are kept as the numbers 1 and 0.
    constants : mapping
        Literals by value.
    """

    def __init__(
        self,
        text: VectorText,
        workspace: Workspace,
        truths: frozenset[int],
        constants: Mapping[int, str],
    ) -> None:
        super().__init__()
        self.rows: dict[int, int] = {}
        self.constants = dict(constants)
        self._text = text
        self._workspace = workspace
        self._truths = truths

    def __getitem__(self, value: int) -> str:
        return self.load(self._text, value)

    def __setitem__(self, value: int, name: str) -> None:
        self.store(self._text, value, name)

    def take(self, values: Iterable[int]) -> None:
        """Find a row for each of some values that has none yet and is no constant."""
        for value in values:
            if value not in self.rows and value not in self.constants:
                self.rows[value] = self._workspace.take()

    def take_together(self, values: Iterable[int]) -> None:
        """Find rows one behind the other for the values that have none yet, in their order."""
        without = dict.fromkeys(
            value for value in values if value not in self.rows and value not in self.constants
        )
        self.rows.update(zip(without, self._workspace.take_together(len(without)), strict=True))

    def give(self, values: Iterable[int]) -> None:
        """Give back the rows of values that are not read again."""
        for value in values:
            if value in self.rows:
                self._workspace.give(self.rows.pop(value))

    def share(self, value: int, other: StoredValues, place: int) -> None:
        """Let a value be one of another block: its row, or its literal."""
        if place in other.constants:
            self.constants[value] = other.constants[place]
        else:
            self.rows[value] = other.rows[place]

    def load(self, text: VectorText, value: int) -> str:
        """Print a load in any function of the kernel and return the name."""
        if value in self.constants:
            return self.constants[value]
        name = text.load(POINTER, self.rows[value])
        if value in self._truths:
            name = text.compare("une", name, text.literal(0.0))
        return name

    def store(self, text: VectorText, value: int, name: str) -> None:
        """Print a store in any function of the kernel, if anyone reads the value."""
        if value not in self.rows:
            return
        if value in self._truths:
            name = text.choose(name, text.literal(1.0), text.literal(0.0))
        text.store(name, POINTER, self.rows[value])

    def fill(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        """Print a copy of vectors of a row at `base` (index, value) to the values."""
        pairs = [(index, self.rows[value]) for index, value in entries if value in self.rows]
        _copy(self._text, base, POINTER, pairs)

    def empty(self, base: str, entries: Iterable[tuple[int, int]]) -> None:
        """Print a copy of values to vectors of a row at `base` (index, value)."""
        pairs = []
        for index, value in entries:
            if value in self.constants:
                self._text.store(self.constants[value], base, index)
            else:
                pairs.append((self.rows[value], index))
        _copy(self._text, POINTER, base, pairs)

    def assign(self, targets: Iterable[int], other: StoredValues, sources: Iterable[int]) -> None:
        """Print a copy of values of this or another block, none of which is a target."""
        pairs = []
        for target, source in zip(targets, sources, strict=True):
            if source in other.constants:
                self[target] = other.constants[source]
            elif target in self.rows:
                pairs.append((other.rows[source], self.rows[target]))
        _copy(self._text, POINTER, POINTER, pairs)

    def follow(self, arguments: Iterable[int], results: Iterable[int]) -> None:
        """Print how results become arguments, for the next turn of a loop.

        A result that is an argument itself is loaded before any argument is overwritten.
        """
        pairs = list(zip(arguments, results, strict=True))
        own = {argument for argument, _ in pairs}
        moved = [(a, self[r]) for a, r in pairs if r in own and r != a]
        new = [(a, r) for a, r in pairs if r not in own]
        self.assign([a for a, _ in new], self, [r for _, r in new])
        for argument, name in moved:
            self[argument] = name


def _copy(text: VectorText, source: str, target: str, pairs: Sequence[tuple[int, int]]) -> None:
    """Print a copy of vectors from one place to another, neighbours at once."""
    copied = 0
    while copied < len(pairs):
        first, to = pairs[copied]
        count = 1
        while pairs[copied + count : copied + count + 1] == [(first + count, to + count)]:
            count += 1
        if count == 1:
            text.store(text.load(source, first), target, to)
        else:
            _copy_neighbours(text, source, first, target, to, count)
        copied += count


def _copy_neighbours(
    text: VectorText, source: str, first: int, target: str, to: int, count: int
) -> None:
    text.declarations.add("declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)")
    start = text.assign(f"getelementptr double, ptr {source}, i64 {first * text.lanes}")
    place = text.assign(f"getelementptr double, ptr {target}, i64 {to * text.lanes}")
    text.line(
        f"call void @llvm.memcpy.p0.p0.i64(ptr align 8 {place}, ptr align 8 {start}, "
        f"i64 {8 * text.lanes * count}, i1 false)"
    )
