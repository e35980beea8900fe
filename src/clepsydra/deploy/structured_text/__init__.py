"""IEC 61131-3 Structured Text of a step program."""
