"""The ways in which loops may be decoupled."""

from typing import Literal

#: By the static gains of the process, or by its dynamics.
Decoupling = Literal["static", "dynamic"]
