"""The names that `import clepsydra` publishes."""

import inspect
from types import ModuleType

import pytest

import clepsydra as cl


@pytest.mark.parametrize("name", cl.__all__)
def test_a_published_name_stays_what_it_is(name):
    """A name equal to a subpackage would turn into that module once it is imported."""
    for _ in range(2):
        thing = getattr(cl, name)
        assert not isinstance(thing, ModuleType)
        assert inspect.getdoc(thing)


def test_an_unknown_name_is_refused():
    with pytest.raises(AttributeError, match="no_such_name"):
        cl.no_such_name  # noqa: B018


def test_names_are_listed():
    assert set(cl.__all__) <= set(dir(cl))
