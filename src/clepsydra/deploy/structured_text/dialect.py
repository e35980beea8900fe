"""The dialects of Structured Text: what one family of systems needs other than the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from clepsydra.base.errors import InputError
from clepsydra.base.language_words import STRUCTURED_TEXT_WORDS
from clepsydra.deploy.printing.identifiers import NameRules
from clepsydra.program.precision import Precision

_FUNCTIONS = {
    "square_root": "SQRT", "absolute": "ABS", "exp": "EXP", "log": "LN", "pow": "EXPT",
    "sin": "SIN", "cos": "COS", "tan": "TAN", "asin": "ASIN", "acos": "ACOS", "atan": "ATAN",
}  # fmt: skip

#: Functions that come with the text, of reals: `a > b ? a : b` and `a < b ? a : b`, which MAX and
#: MIN of a system are not where one is no number, or where both are zeros, and rounding to whole
#: numbers that need not fit an integer.
OWN = {"maximum": "FC_Max", "minimum": "FC_Min", "floor": "FC_Floor", "ceiling": "FC_Ceiling"}


@dataclass(frozen=True)
class Dialect:
    """What a family of systems needs other than the others; the rest is common.

    Parameters
    ----------
    name : str
    systems : str
        The systems that take the text.
    words : frozenset of str
        Upper-case words that are no names there, beside those of the standard.
    longest_name : int
        Longest identifier [characters]; 0 where the system sets no limit that matters.
    functions : mapping
        Code of an operation to the function of the standard or of the system.
    formal : mapping
        Code of an operation to the names of the parameters of its function, where the system
        wants them written.
    power : str
        Operator of a power, where there is no function for it.
    truncate : str
        Function that cuts a number off to a DINT.
    typed_numbers : frozenset of {"double", "single"}
        Precisions in which a number in a statement needs its type before it.
    literals : (float, float)
        Smallest and largest magnitude that the system reads as a number; none where empty.
    absolute_zero : bool
        Whether ABS makes the negative zero positive.
    constant_arrays : bool
        Whether a block may declare a constant array.
    instances_alone : bool
        Whether every instance of a block needs a declaration of its own.
    one_turn : bool
        Whether every system takes the only turn of a FOR from a number to the same number.
    line_comments : bool
        Whether comments are written ``// …`` to the end of the line, not ``(* … *)``.
    block_quote : str
        What stands around the name of a block.
    local_mark : str
        What stands before the name of a variable of the block in a statement.
    attributes : tuple of str
        Lines between the name of a block and its declarations.
    begin : str
        Line between declarations and statements.
    configuration : bool
        Whether tasks are part of the text.
    programs : bool
        Whether there are PROGRAMs in the text.
    declarations_as_text : bool
        Whether the declarations stand as text, too, in XML for these systems, whose paragraphs are
        then XHTML without a prefix.

    Examples
    --------
    >>> dialect_of("codesys").truncate, dialect_of("scl").truncate
    ('TRUNC', 'TRUNC_DINT')
    """

    name: str
    systems: str
    words: frozenset[str] = frozenset()
    longest_name: int = 0
    functions: Mapping[str, str] = field(default_factory=lambda: _FUNCTIONS)
    formal: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    power: str = ""
    truncate: str = "TRUNC"
    typed_numbers: frozenset[Precision] = frozenset({"single"})
    literals: tuple[float, float] | None = None
    absolute_zero: bool = True
    constant_arrays: bool = True
    instances_alone: bool = False
    one_turn: bool = True
    line_comments: bool = False
    block_quote: str = ""
    local_mark: str = ""
    attributes: tuple[str, ...] = ()
    begin: str = ""
    configuration: bool = False
    programs: bool = True
    declarations_as_text: bool = False

    @property
    def all_words(self) -> frozenset[str]:
        """Words of the standard, of the system and of the functions that come with a text."""
        return STRUCTURED_TEXT_WORDS | self.words | {name.upper() for name in OWN.values()}

    @property
    def names(self) -> NameRules:
        """What the systems accept as a name."""
        return NameRules("Structured Text", self.all_words, True, self.longest_name, self.systems)

    def commented(self, text: str) -> str:
        """Return a text as a comment of one line.

        >>> dialect_of("codesys").commented("state"), dialect_of("scl").commented("state")
        ('(* state *)', '// state')
        """
        return f"// {text}" if self.line_comments else f"(* {text} *)"

    def quoted(self, block: str) -> str:
        """Return the name of a block as it is written.

        >>> dialect_of("codesys").quoted("level_pi"), dialect_of("scl").quoted("level_pi")
        ('level_pi', '"level_pi"')
        """
        return f"{self.block_quote}{block}{self.block_quote}"


_MATIEC = Dialect(
    "matiec",
    "OpenPLC and Beremiz",
    # Function blocks of the library that comes with it; a variable may not have their names.
    words=frozenset("DERIVATIVE HYSTERESIS INTEGRAL PID RAMP RTC SEMA".split()),  # noqa: SIM905
    # A number without a type becomes a double of C, so a REAL would be computed as a double:
    # typed numbers in single precision are the default of every dialect.
    # It reads numbers by the C function strtof, whatever their type, and refuses what that
    # cannot represent, although it writes the number itself into the C program.
    literals=(2.0**-126, (2.0 - 2.0**-23) * 2.0**127),
    # Its ABS changes the sign of what is less than zero, which the negative zero is not.
    absolute_zero=False,
    # It crashes on some declarations of several.
    instances_alone=True,
    # Since it has CONTINUE, that of Beremiz leaves a FOR whose ends are equal before its turn.
    one_turn=False,
    configuration=True,
)
_CODESYS = Dialect(
    "codesys",
    "CODESYS and TwinCAT 3",
    declarations_as_text=True,
    words=frozenset(
        # Operators, instructions and scopes of these systems beside those of the standard.
        """
        ADR ANDN AND_THEN ANY_STRING BIT BITADR CAL CALC CALCN INDEXOF INI JMP JMPC JMPCN LD LDN
        ORN OR_ELSE PARAMS PERSISTENT POINTER PVOID REFERENCE RET RETC RETCN SIZEOF ST STN
        TRUNC_INT UXINT VAR_GENERIC VAR_INST VAR_STAT XINT XORN XSIZEOF XWORD
        """.split()  # noqa: SIM905
    ),
    # A number without a type is an LREAL there: REAL variables would be computed as LREAL, and
    # every assignment would lose digits with a warning. Hence the default of `typed_numbers`.
)
_SCL = Dialect(
    "scl",
    "Siemens TIA Portal",
    longest_name=125,  # of a block's name
    # The power is an operator, and there is no arc tangent of two arguments.
    functions={code: name for code, name in _FUNCTIONS.items() if code != "pow"},
    formal={
        "select": ("G", "IN0", "IN1"),
        "integer maximum": ("IN1", "IN2"),
        "integer minimum": ("IN1", "IN2"),
        "maximum": ("a", "b"),
        "minimum": ("a", "b"),
    },
    power="**",
    # Without a type the result has that of the operands around it.
    truncate="TRUNC_DINT",
    # A number without a type takes the type of the operands around it, which in a comparison of
    # function results is not evident: so each one says its own.
    typed_numbers=frozenset({"double", "single"}),
    # Local constants are elementary; an array with initial values is static.
    constant_arrays=False,
    # The comment behind a declaration goes into the comment column of the interface.
    line_comments=True,
    block_quote='"',
    local_mark="#",
    attributes=("{ S7_Optimized_Access := 'TRUE' }", "VERSION : 0.1"),
    begin="BEGIN",
    # Cyclic calls come from an organisation block, made in the portal with its cycle time.
    programs=False,
)
_DIALECTS = {dialect.name: dialect for dialect in (_MATIEC, _CODESYS, _SCL)}

#: Names of the dialects.
DIALECT_NAMES = tuple(_DIALECTS)


def dialect_of(name: str) -> Dialect:
    """Return a dialect by its name.

    Raises
    ------
    InputError
        There is none of that name.

    Examples
    --------
    >>> dialect_of("matiec").systems
    'OpenPLC and Beremiz'
    """
    if name not in _DIALECTS:
        raise InputError(
            "dialect", name, f"one of {', '.join(DIALECT_NAMES)}",
            "choose the one of the system that will run the text: "
            + "; ".join(f"{dialect.name} for {dialect.systems}" for dialect in _DIALECTS.values()),
        )  # fmt: skip
    return _DIALECTS[name]
