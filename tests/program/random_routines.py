"""Random routines of loops over arrays, as the Python text that writes them."""

from dataclasses import dataclass

from hypothesis import strategies as st

IMPORT = "from clepsydra.program.routine_writer import routine"
#: A shape of two indices: rows, columns, a loop over columns, a place there, and another one.
_PLACES = (
    ("0, {m}", "i, j", "{n} - 1 - i, {m} - 1 - j"),
    ("0, {m}", "{n} - 1 - i, j", "0, j"),
    ("{m} - 1 - 0 * i, {m}", "i, j", "{n} - 1, j"),
)
_FORMS = (
    "{0} + {1} * {2}", "{0} - {1} / {2}", "ca.fmax({0}, {1}) - {2}", "ca.sqrt({0} * {1})",
    "ca.if_else({0} < {1}, {2}, {1})", "ca.if_else({0} <= {1}, {0} * {2}, 0.5)", "-{0}", "2.5",
)  # fmt: skip


@dataclass(frozen=True)
class WrittenRoutine:
    """A routine that some lines of text write under a name."""

    name: str
    lines: list[str]
    #: Whether each element that it is given is a number.
    known: list[bool]
    results: int


@st.composite
def routines(draw, name: str) -> WrittenRoutine:
    """A routine of random loops over arrays of one shape."""
    n, m = draw(st.sampled_from([1, 2, 3])), draw(st.sampled_from([1, 2]))
    given = [f"given_{k}" for k in range(draw(st.integers(1, 2)))]
    arrays = [*given, "found", "kept"]
    lines = [
        f"def {name}(loop, {', '.join(arrays)}, single):",
        f"    single[()] = {given[0]}[0, 0]",
        f"    for i in loop('i', 0, {n}):",
        f"        for j in loop('j', 0, {m}):",
    ]
    lines += [f"            {a}[i, j] = {draw(st.sampled_from(given))}[i, j]" for a in arrays[-2:]]
    for _ in range(draw(st.integers(1, 3))):
        first = draw(st.sampled_from([0, n - 1]))
        columns, place, other = (part.format(n=n, m=m) for part in draw(st.sampled_from(_PLACES)))
        lines.append(f"    for i in loop('i', {first}, {n}):")
        lines.append(f"        for j in loop('j', {columns}):")
        written = draw(st.sampled_from([f"found[{place}]", f"kept[{place}]", "single[()]"]))
        every = [f"{array}[{at}]" for array in arrays for at in (place, other)]
        read = [draw(st.sampled_from([*every, "single[()]"])) for _ in range(3)]
        lines.append(f"            {written} = {draw(st.sampled_from(_FORMS)).format(*read)}")
    shape = f"({n}, {m})"
    of = ", ".join(f"'{each}': {shape}" for each in given)
    lines.append(
        f"{name} = routine('mixed', {name}, arguments={{{of}}}, results={{'found': {shape}}}, "
        f"local={{'kept': {shape}, 'single': ()}})"
    )
    known = [known for _ in given for known in [draw(st.booleans())] * (n * m)]
    return WrittenRoutine(name, lines, known, n * m)
