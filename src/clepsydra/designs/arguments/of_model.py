"""Arguments of a design that are read before its model is known."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, TypeVar

if TYPE_CHECKING:
    from clepsydra.linear.linear_model import LinearModel

T = TypeVar("T")


class OfModel(Generic[T]):
    """An argument that is known only with the model.

    Examples
    --------
    >>> OfModel(lambda model: 2).of(None)
    2
    """

    def __init__(self, of: Callable[[LinearModel], T]) -> None:
        self.of = of
