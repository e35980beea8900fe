"""Words of the languages that Clepsydra prints: no name of a signal is one of them."""

from __future__ import annotations

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
