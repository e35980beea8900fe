"""What a Modbus server answers where it cannot do what it was asked."""

from __future__ import annotations

from enum import IntEnum


class ExceptionCode(IntEnum):
    """The exception codes of the Modbus Application Protocol V1.1b3, section 7."""

    ILLEGAL_FUNCTION = 1
    ILLEGAL_DATA_ADDRESS = 2
    ILLEGAL_DATA_VALUE = 3
    SERVER_DEVICE_FAILURE = 4
    ACKNOWLEDGE = 5
    SERVER_DEVICE_BUSY = 6
    MEMORY_PARITY_ERROR = 8
    GATEWAY_PATH_UNAVAILABLE = 10
    GATEWAY_TARGET_DEVICE_FAILED_TO_RESPOND = 11

    @property
    def words(self) -> str:
        """Its name as the specification writes it.

        >>> ExceptionCode.ILLEGAL_DATA_ADDRESS.words
        'illegal data address'
        """
        return self.name.lower().replace("_", " ")


def exception_words(code: int) -> str:
    """Return an exception code in words, known or not.

    >>> exception_words(2), exception_words(77)
    ('exception 2, illegal data address', 'exception 77')
    """
    known = code in set(ExceptionCode)
    return f"exception {code}" + (f", {ExceptionCode(code).words}" if known else "")


class ModbusRefusal(Exception):
    """A request that is answered with an exception code.

    Parameters
    ----------
    code : ExceptionCode
    """

    def __init__(self, code: ExceptionCode) -> None:
        super().__init__(exception_words(code))
        self.code = code
