"""The bytes of a value are those that asyncua writes, and reads back."""

import random

from tools import missing, need

if not missing("asyncua", "cryptography"):
    from asyncua import ua
    from asyncua.common.utils import Buffer
    from asyncua.ua.ua_binary import struct_from_binary, struct_to_binary

    from clepsydra.rig.doors.opc_ua.told_value import OVERFLOW, ToldValue


def some_values():
    draws = random.Random(5)
    for _ in range(200):
        when = draws.uniform(0.0, 4e9)
        yield "Double", draws.uniform(-1e9, 1e9), 0, when
        yield "UInt16", float(draws.randrange(1 << 16)), 0x40940000, when
        yield "UInt32", float(draws.randrange(1 << 19)), 0, when
        yield "Boolean", float(draws.randrange(2)), 0, when
        yield "Double", None, 0x808C0000, when


def test_the_bytes_are_those_of_asyncua():
    need("asyncua", "cryptography")
    for kind, value, status, when in some_values():
        told = ToldValue(ua.VariantType[kind], value, status, when)
        theirs = told.data_value()
        if value is None:
            # asyncua says that there is a value of no type; that there is none is the same.
            read = struct_from_binary(ua.DataValue, Buffer(told.encoded()))
            assert read.Value.Value is None
            assert read.StatusCode == theirs.StatusCode
            assert read.SourceTimestamp == theirs.SourceTimestamp
        else:
            assert told.encoded() == struct_to_binary(theirs)


def test_a_value_after_a_loss_says_so():
    need("asyncua", "cryptography")
    told = ToldValue(ua.VariantType.Double, 1.5, 0, 1.8e9)
    read = struct_from_binary(ua.DataValue, Buffer(told.after_a_loss()))
    assert (read.Value.Value, read.StatusCode.value) == (1.5, OVERFLOW)
