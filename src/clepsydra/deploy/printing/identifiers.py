"""Names of a printed program: what may be one, and new ones that clash with nothing."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

from clepsydra.base.errors import InputError

_IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

#: Words of C99, types and macros of its standard headers that a printed file includes, the
#: words of C++, since the header may be included there, and macros that compilers predefine.
C_WORDS = frozenset(
    """
    auto break case char const continue default do double else enum extern float for goto if
    inline int long register restrict return short signed sizeof static struct switch typedef
    union unsigned void volatile while bool true false NULL asm catch class const_cast delete
    dynamic_cast explicit export friend mutable namespace new operator private protected public
    reinterpret_cast static_cast template this throw try typeid typename using virtual wchar_t
    and and_eq bitand bitor compl not not_eq or or_eq xor xor_eq alignas alignof char16_t
    char32_t constexpr decltype noexcept nullptr static_assert thread_local int8_t int16_t
    int32_t int64_t uint8_t uint16_t uint32_t uint64_t INFINITY NAN HUGE_VAL HUGE_VALF HUGE_VALL
    FP_FAST_FMA FP_FAST_FMAF FP_FAST_FMAL FP_ILOGB0 FP_ILOGBNAN FP_INFINITE FP_NAN FP_NORMAL
    FP_SUBNORMAL FP_ZERO MATH_ERREXCEPT MATH_ERRNO math_errhandling M_1_PI M_2_PI M_2_SQRTPI M_E
    M_LN10 M_LN2 M_LOG10E M_LOG2E M_PI M_PI_2 M_PI_4 M_SQRT1_2 M_SQRT2 DECIMAL_DIG
    FLT_EVAL_METHOD FLT_RADIX FLT_ROUNDS linux unix
    """.split()  # noqa: SIM905
    # Of <stdint.h> and <float.h>: the limits of every type.
    + [
        f"{sign}INT{size}_{end}"
        for sign in ("", "U")
        for size in (
            *("MAX", "PTR"),
            *(f"{kind}{bits}" for kind in ("", "_LEAST", "_FAST") for bits in (8, 16, 32, 64)),
        )
        for end in ("MIN", "MAX")
    ]
    + [
        f"{name}_{end}"
        for name in ("PTRDIFF", "SIG_ATOMIC", "SIZE", "WCHAR", "WINT")
        for end in ("MIN", "MAX")
    ]
    + [
        f"{real}_{what}"
        for real in ("FLT", "DBL", "LDBL")
        for what in (
            *("DIG", "EPSILON", "MANT_DIG", "MAX", "MAX_10_EXP", "MAX_EXP"),
            *("MIN", "MIN_10_EXP", "MIN_EXP"),
        )
    ]
)

#: Words of IEC 61131-3 (third edition): keywords, elementary types, standard functions.
STRUCTURED_TEXT_WORDS = frozenset(
    """
    ABSTRACT ACTION AND ARRAY AT BY CASE CLASS CONFIGURATION CONSTANT CONTINUE DO ELSE ELSIF
    END_ACTION END_CASE END_CLASS END_CONFIGURATION END_FOR END_FUNCTION END_FUNCTION_BLOCK
    END_IF END_INTERFACE END_METHOD END_NAMESPACE END_PROGRAM END_PROPERTY END_REPEAT
    END_RESOURCE END_STEP END_STRUCT END_TRANSITION END_TYPE END_UNION END_VAR END_WHILE EN ENO
    EXIT EXTENDS FALSE FINAL FOR FROM FUNCTION FUNCTION_BLOCK F_EDGE GET IF IMPLEMENTS
    INITIAL_STEP INTERFACE INTERNAL INTERVAL METHOD MOD NAMESPACE NON_RETAIN NOT NULL OF ON OR
    OVERLAP OVERRIDE PRIORITY PRIVATE PROGRAM PROPERTY PROTECTED PUBLIC READ_ONLY READ_WRITE
    REF REF_TO REPEAT RESOURCE RETAIN RETURN R_EDGE SET SINGLE STEP STRUCT SUPER TASK THEN THIS
    TO TRANSITION TRUE TYPE UNION UNTIL USING VAR VAR_ACCESS VAR_CONFIG VAR_EXTERNAL VAR_GLOBAL
    VAR_INPUT VAR_IN_OUT VAR_OUTPUT VAR_TEMP WHILE WITH XOR BOOL BYTE CHAR DATE DATE_AND_TIME
    DINT DT DWORD INT LDATE LDATE_AND_TIME LDT LINT LREAL LTIME LTIME_OF_DAY LTOD LWORD REAL
    SINT STRING TIME TIME_OF_DAY TOD UDINT UINT ULINT USINT WCHAR WORD WSTRING ANY ANY_BIT
    ANY_INT ANY_NUM ANY_REAL ABS ACOS ADD ASIN ATAN ATAN2 CONCAT COS DELETE DIV EQ EXP EXPT
    FIND GE GT INSERT LE LEFT LEN LIMIT LN LOG LT MAX MID MIN MOVE MUL MUX NE REPLACE RIGHT ROL
    ROR SEL SHL SHR SIN SQRT SUB TAN TRUNC CTD CTU CTUD F_TRIG R_TRIG RS SR TOF TON TP
    """.split()  # noqa: SIM905
)


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
    >>> names.new("Limit"), names.new("error"), names.temporary()
    ('Limit_2', 'error', 't1')
    """

    def __init__(self, taken: Iterable[str], *, ignore_case: bool) -> None:
        self._ignore_case = ignore_case
        self._taken = {self._key(name) for name in taken}
        self._temporaries = 0

    def new(self, wanted: str) -> str:
        """Return the wanted name, or that name with a number where it is taken."""
        wanted = re.sub(r"[^A-Za-z0-9]+", "_", wanted).strip("_")
        if not wanted or wanted[0].isdigit():
            wanted = f"value_{wanted}".rstrip("_")
        name, number = wanted, 1
        while self._key(name) in self._taken:
            number += 1
            name = f"{wanted}_{number}"
        self._taken.add(self._key(name))
        return name

    def is_free(self, name: str) -> bool:
        """Whether nothing has a name yet.

        >>> Identifiers(["limit"], ignore_case=True).is_free("Limit")
        False
        """
        return self._key(name) not in self._taken

    def temporary(self) -> str:
        """Return the next of the names t1, t2, … that is free."""
        while True:
            self._temporaries += 1
            name = f"t{self._temporaries}"
            if self._key(name) not in self._taken:
                self._taken.add(self._key(name))
                return name

    def _key(self, name: str) -> str:
        return name.lower() if self._ignore_case else name


def check_identifier(
    name: str, place: str, language: str, words: frozenset[str], *, ignore_case: bool
) -> None:
    """Refuse a name that a language does not accept.

    Raises
    ------
    InputError
        The name is no identifier or is a word of the language.

    Examples
    --------
    >>> check_identifier("level_1", "law, level_1", "C", C_WORDS, ignore_case=False)
    >>> try:
    ...     check_identifier("double", "law, double", "C", C_WORDS, ignore_case=False)
    ... except InputError as error:
    ...     print(error)
    law, double: got 'double', expected a name that is no word of C; rename it.
    """
    if not _IDENTIFIER.fullmatch(name) or "__" in name or name.endswith("_"):
        raise InputError(
            place,
            name,
            f"an identifier of {language}: letters, digits and single underscores, a letter first",
            "rename it",
        )
    if (name.upper() if ignore_case else name) in words:
        raise InputError(place, name, f"a name that is no word of {language}", "rename it")


def check_distinct(entries: Iterable[tuple[str, str]], language: str, *, ignore_case: bool) -> None:
    """Refuse names that a language cannot tell apart.

    Parameters
    ----------
    entries : iterable of (str, str)
        Name and the place where it stands.

    Raises
    ------
    InputError
        Two names are the same.

    Examples
    --------
    >>> entries = [("Level", "law, Level"), ("level", "law, level")]
    >>> check_distinct(entries, "C", ignore_case=False)
    >>> try:
    ...     check_distinct(entries, "Structured Text", ignore_case=True)
    ... except InputError as error:
    ...     print(error.expected)
    a name that differs in Structured Text from law, Level
    """
    seen: dict[str, str] = {}
    for name, place in entries:
        key = name.lower() if ignore_case else name
        if key in seen:
            raise InputError(
                place, name, f"a name that differs in {language} from {seen[key]}", "rename one"
            )
        seen[key] = place
