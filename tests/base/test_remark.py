"""A remark is its whole text, and stays what it is where it is copied."""

import copy
import pickle

import pytest

from clepsydra.base.remark import Remark


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda said: pickle.loads(pickle.dumps(said))])
@pytest.mark.parametrize(
    "parts", [("a spills",), ("a spills", "it is low"), ("a", "b", "raise it")]
)
def test_a_copy_has_the_text_and_the_parts(copied, parts):
    said = Remark(*parts)
    other = copied(said)
    assert (other, other.brief, other.advice) == (said, said.brief, said.advice)
