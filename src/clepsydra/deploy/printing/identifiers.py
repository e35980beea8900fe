"""Names of a printed program: what may be one, and new ones that clash with nothing."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

from clepsydra.base.errors import InputError
from clepsydra.base.language_words import C_WORDS, STRUCTURED_TEXT_WORDS

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def identifier_of(text: str, words: frozenset[str] = C_WORDS | STRUCTURED_TEXT_WORDS) -> str:
    """Return an identifier made from a title: lower case, words joined by underscores.

    Accents are dropped. Where the title begins with a digit, or is a word of a language, "law_"
    stands before it.

    Parameters
    ----------
    text : str
    words : frozenset of str
        What it may not be, in upper or lower case.

    Raises
    ------
    InputError
        The text has no letter or digit of the Latin alphabet.

    Examples
    --------
    >>> identifier_of("PI, SIMC, dynamic decoupling"), identifier_of("2DOF polynomial, LQ")
    ('pi_simc_dynamic_decoupling', 'law_2dof_polynomial_lq')
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    name = re.sub(r"[^a-z0-9]+", "_", plain).strip("_")
    if not name:
        raise InputError(
            f"name {text!r}", text, "a name with a letter from A to Z or a digit", "rename it"
        )
    taken = name[0].isdigit() or name in {word.lower() for word in words}
    return f"law_{name}" if taken else name


class Identifiers:
    """The names that one scope of a printed program has used.

    Parameters
    ----------
    taken : iterable of str
        Names and words that a new name must not equal.
    ignore_case : bool
        Whether the language takes ``Level`` and ``level`` for the same name.

    Examples
    --------
    >>> names = Identifiers(["limit"], ignore_case=True)
    >>> names.new("Limit"), names.new("error"), names.new("Limit")
    ('Limit_2', 'error', 'Limit_3')
    """

    def __init__(self, taken: Iterable[str], *, ignore_case: bool) -> None:
        self._ignore_case = ignore_case
        self._taken = {self._key(name) for name in taken}
        self._numbers: dict[str, int] = {}
        self._shared: dict[tuple[str, object], str] = {}

    def new(self, wanted: str) -> str:
        """Return the wanted name, or that name with a number where it is taken."""
        wanted = re.sub(r"[^A-Za-z0-9]+", "_", wanted).strip("_")
        if not wanted or wanted[0].isdigit():
            wanted = f"value_{wanted}".rstrip("_")
        key = self._key(wanted)
        name, number = wanted, self._numbers.get(key, 1)
        while not self.is_free(name):
            number += 1
            name = f"{wanted}_{number}"
        self._numbers[key] = number
        self._taken.add(self._key(name))
        return name

    def shared(self, wanted: str, key: object) -> str:
        """Return the name that all with one key have who want it.

        >>> names = Identifiers([], ignore_case=True)
        >>> names.shared("i", 0), names.shared("i", 1), names.shared("i", 0)
        ('i', 'i_2', 'i')
        """
        if (wanted, key) not in self._shared:
            self._shared[wanted, key] = self.new(wanted)
        return self._shared[wanted, key]

    def is_free(self, name: str) -> bool:
        """Whether nothing has a name yet.

        >>> Identifiers(["limit"], ignore_case=True).is_free("Limit")
        False
        """
        return self._key(name) not in self._taken

    def _key(self, name: str) -> str:
        return name.lower() if self._ignore_case else name


@dataclass(frozen=True)
class NameRules:
    """What a language accepts as a name.

    Parameters
    ----------
    language : str
    words : frozenset of str
        Those that are no names; in upper case where the language ignores the case.
    ignore_case : bool
    longest : int
        Longest name [characters]; 0 where there is no limit that matters.
    systems : str
        Those that have this limit.

    Examples
    --------
    >>> rules = NameRules("C", C_WORDS)
    >>> rules.check("level_1", "law, level_1")
    >>> try:
    ...     rules.check("double", "law, double")
    ... except InputError as error:
    ...     print(error)
    law, double: got 'double', expected a name that is no word of C; rename it.
    """

    language: str
    words: frozenset[str]
    ignore_case: bool = False
    longest: int = 0
    systems: str = ""

    def check(self, name: str, place: str) -> None:
        """Refuse what is no identifier, is a word of the language, or is too long."""
        language, expected, remedy = self.language, "", "rename it"
        if not _IDENTIFIER.fullmatch(name) or "__" in name or name.endswith("_"):
            expected = f"an identifier of {language}: letters, digits and single underscores, "
            expected += "a letter first"
        elif (name.upper() if self.ignore_case else name) in self.words:
            expected = f"a name that is no word of {language}"
        elif 0 < self.longest < len(name):
            expected = f"at most {self.longest} characters for {self.systems}"
            remedy = "give it a shorter name"
        if expected:
            raise InputError(place, name, expected, remedy)

    def check_distinct(self, entries: Iterable[tuple[str, str]]) -> None:
        """Refuse names, each with the place where it stands, that the language cannot tell apart.

        >>> entries = [("Level", "law, Level"), ("level", "law, level")]
        >>> NameRules("C", C_WORDS).check_distinct(entries)
        >>> try:
        ...     NameRules("Structured Text", frozenset(), ignore_case=True).check_distinct(entries)
        ... except InputError as error:
        ...     print(error.expected)
        a name that differs in Structured Text from law, Level
        """
        seen: dict[str, str] = {}
        for name, place in entries:
            key = name.lower() if self.ignore_case else name
            if key in seen:
                expected = f"a name that differs in {self.language} from {seen[key]}"
                raise InputError(place, name, expected, "rename one")
            seen[key] = place
