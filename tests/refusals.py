"""What a refusal says, by its fields, so that a sentence may be worded better without a test."""

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from clepsydra import InputError

_ANY = object()


@contextmanager
def refused(
    *, place: str = "", value: object = _ANY, expected: str = "", remedy: str = ""
) -> Iterator[pytest.ExceptionInfo[InputError]]:
    """Expect an input to be refused, with this value and with these words in the other fields."""
    with pytest.raises(InputError) as caught:
        yield caught
    error = caught.value
    if value is not _ANY:
        assert error.value == value
    said = {"place": error.place, "expected": error.expected, "remedy": error.remedy}
    for field, words in (("place", place), ("expected", expected), ("remedy", remedy)):
        assert words in said[field], field
