"""Every block that a tuning is translated for."""

from __future__ import annotations

from clepsydra.base.errors import InputError
from clepsydra.deploy.vendor_tuning.vendor_block import VendorBlock
from clepsydra.deploy.vendor_tuning.vendors import (
    emerson,
    languages,
    others,
    rockwell,
    schneider,
    siemens,
)

#: In the order in which they are shown.
EVERY_BLOCK: tuple[VendorBlock, ...] = (
    *siemens.BLOCKS,
    *rockwell.BLOCKS,
    *languages.BLOCKS,
    *schneider.BLOCKS,
    *emerson.BLOCKS,
    *others.BLOCKS,
)


def vendor_block(key: str) -> VendorBlock:
    """Return the block of a key.

    Raises
    ------
    InputError
        There is none.

    Examples
    --------
    >>> vendor_block("codesys-pid").parameters[1].name
    'TN'
    """
    for block in EVERY_BLOCK:
        if block.key == key:
            return block
    known = ", ".join(block.key for block in EVERY_BLOCK)
    raise InputError("vendor's block", key, f"one of {known}", "correct the key")
