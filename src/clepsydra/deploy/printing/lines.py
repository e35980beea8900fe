"""Lines of statements: computed in place, with comments above steps, and of good length."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence

#: Longest line where it can be helped [characters].
LINE = 100
_STEP = "  "
_BREAKS = re.compile(r"(?P<sign>[()\[\]]|,|:=|(?<= )(?:AND|OR|&&|\|\||[?:]|[<>=!]+|[-+*/])(?= ))")
_OPENING, _CLOSING = "([", ")]"
# How much holds together what stands beside a sign; a line is broken there where it is least.
_TIGHT = {":=": 0, "=": 0, ",": 0, "?": 0, ":": 0, "OR": 1, "||": 1, "AND": 2, "&&": 2, "+": 4,
          "-": 4} | dict.fromkeys(("<", "<=", "<>", ">", ">=", "==", "!="), 3)  # fmt: skip
_BRANCH = re.compile(r" *((IF|ELSIF)\b.* THEN|ELSE)$")
_COMPOUND = re.compile(r" *(IF|FOR|\(\*|//)")
#: A line is broken before that many characters only where it cannot be helped.
_LEAST = 40


def folded(line: str, longest: int = LINE) -> Iterator[str]:
    """Yield a statement on lines that are not too long, broken where it holds least together.

    Examples
    --------
    >>> long = "  total_inflow := first_inflow + second_inflow * (first_share + second_share)"
    >>> print("\\n".join(folded(f"{long} + third_inflow * third_share;")))
      total_inflow := first_inflow + second_inflow * (first_share + second_share)
          + third_inflow * third_share;
    """
    start = len(line) - len(line.lstrip())
    indent, opened = line[:start] + _STEP * 2, 0
    while len(line) > longest:
        places: list[tuple[bool, int, int, int]] = []
        depth, brackets = opened, []
        for found in _BREAKS.finditer(line, start):
            sign = found["sign"]
            if sign in _OPENING or sign in _CLOSING:
                depth += 1 if sign in _OPENING else -1
                if sign in _OPENING and found.end() <= longest:
                    brackets.append((False, depth, 0, -found.end()))
                continue
            # A comma and an assignment stay where they are, an operator goes to the next line.
            at = found.end() + 1 if sign in (",", ":=") else found.start("sign")
            # What a line begins with is no place to break it.
            if at <= start or at >= len(line) or (sign in (":=", "=>") and depth):
                continue
            far = len(line[:at].rstrip()) > longest
            # Where nothing is near enough, the next place is taken.
            if not far or not (places or brackets):
                places.append((at < start + _LEAST, depth, _TIGHT.get(sign, 5), -at))
            if far:
                break
        # Behind a bracket only where nothing else is near enough.
        places = places or brackets[:1]
        if not places:
            break
        _, opened, _, at = min(places)
        yield line[:-at].rstrip()
        start, line = len(indent), indent + line[-at:]
    yield line


def indented(lines: Iterable[str]) -> list[str]:
    """Return lines a step further in.

    >>> indented(["u := 0.0;"])
    ['  u := 0.0;']
    """
    return [f"  {line}" for line in lines]


def dense(lines: Sequence[str]) -> list[str]:
    """Return statements with what a branch of an IF does beside its condition, if that is short.

    Examples
    --------
    >>> print("\\n".join(dense(["IF late THEN", "  scans := 0;", "END_IF;"])))
    IF late THEN scans := 0; END_IF;
    >>> print("\\n".join(dense(["IF a THEN", "  b := 1;", "ELSE", "  b := 2;", "END_IF;"])))
    IF a THEN b := 1;
    ELSE b := 2;
    END_IF;
    """
    found: list[str] = []
    rest = list(lines)
    while rest:
        head, inside, after = (*rest[:3], "", "")[:3]
        whole = f"{head} {inside.lstrip()}"
        # Of a branch with one statement the end follows, as far in as its beginning.
        short = _BRANCH.match(head) and not _COMPOUND.match(inside) and _next(head, after)
        if not short or len(whole) > LINE:
            found.append(rest.pop(0))
            continue
        closed = f"{whole} END_IF;"
        alone = head.lstrip().startswith("IF ") and after.lstrip() == "END_IF;"
        alone = alone and len(closed) <= LINE
        found.append(closed if alone else whole)
        del rest[: 3 if alone else 2]
    return found


def _next(head: str, after: str) -> bool:
    """Whether a line begins the next branch, or ends the last one."""
    word = after.lstrip()
    beside = len(after) - len(word) == len(head) - len(head.lstrip())
    return beside and word.startswith(("ELSIF ", "ELSE", "END_IF;"))


def mentions(line: str, name: str) -> bool:
    """Whether a line reads or assigns a variable.

    Examples
    --------
    >>> mentions("t1 := t10 + tank.t;", "t1"), mentions("t1 := t10 + tank.t;", "t")
    (True, False)
    """
    return re.search(_whole(name), line) is not None


def in_place(lines: list[str], variables: Container[str], places: Iterable[str]) -> list[str]:
    """Return statements in which a variable that a result is read from is that result.

    Parameters
    ----------
    lines : list of str
    variables : container of str
        Those that nothing else knows.
    places : iterable of str
        What the results are assigned to.

    Examples
    --------
    >>> in_place(["t1 := a + b;", "z := c * t1;", "y := t1;"], ["t1"], ["y"])
    ['y := a + b;', 'z := c * y;']
    """
    for place in places:
        for k, line in enumerate(lines):
            found = re.fullmatch(rf"{re.escape(place)} :?= (\w+);", line)
            if found is None or found[1] not in variables:
                continue
            first = next(j for j, each in enumerate(lines) if mentions(each, found[1]))
            later = [*lines[first:k], *lines[k + 1 :]]
            # What stands in no branch or loop may read what it overwrites.
            once = not lines[first].startswith(" ")
            if not any(mentions(each, place) for each in later[once:]):
                renamed = (re.sub(_whole(found[1]), place, each) for each in later)
                lines = [*lines[:first], *renamed]
            break
    return lines


#: How a line begins that is part of the statement above it.
_PART = re.compile(r" |ELSE|ELSIF|END_|\}")


def explained(lines: Sequence[str], told: Mapping[str, Sequence[str]]) -> list[str]:
    """Return statements with rows of comment above those that compute what the rows tell of.

    Where more than one assigns it, that is the last, with what it holds otherwise.

    Examples
    --------
    >>> explained(["y = 0;", "if (on) {", "  y = x;", "}"], {"y": ["/* the reading */"]})
    ['/* the reading */', 'y = 0;', 'if (on) {', '  y = x;', '}']
    """
    above: dict[int, list[str]] = {}
    for place, rows in told.items():
        assigns = re.compile(rf" *{re.escape(place)} :?= ")
        found = [k for k, line in enumerate(lines) if assigns.match(line)]
        if not found:
            continue
        k = found[-1]
        while k and (_PART.match(lines[k]) or assigns.match(lines[k - 1])):
            k -= 1
        above.setdefault(k, []).extend(rows)
    return [row for k, line in enumerate(lines) for row in (*above.get(k, ()), line)]


def _whole(name: str) -> str:
    return rf"(?<![\w.>]){re.escape(name)}\b"
