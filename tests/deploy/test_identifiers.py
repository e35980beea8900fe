"""Titles as identifiers of every target."""

import re
import string

import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refused

from clepsydra.deploy.printing.identifiers import (
    C_WORDS,
    STRUCTURED_TEXT_WORDS,
    NameRules,
    identifier_of,
)
from clepsydra.studies.designs import DESIGNS


@pytest.mark.parametrize(
    ("title", "name"),
    [
        ("PI, SIMC, dynamic decoupling", "pi_simc_dynamic_decoupling"),
        ("2DOF polynomial, LQ", "law_2dof_polynomial_lq"),
        ("  H∞: Glover-McFarlane on PI (SIMC) ", "h_glover_mcfarlane_on_pi_simc"),
        ("Åström & Hägglund", "astrom_hagglund"),
        ("wet-well:start-stop", "wet_well_start_stop"),
        ("a__b_", "a_b"),
        ("Program", "law_program"),
        ("double", "law_double"),
        ("NOT", "law_not"),
        ("nan", "law_nan"),
    ],
)
def test_a_title_becomes_a_name(title, name):
    assert identifier_of(title) == name


@pytest.mark.parametrize("title", ["", "…", "水位", "_ _"])
def test_a_title_without_letters_is_refused(title):
    with refused(expected="a letter from A to Z or a digit", remedy="rename it"):
        identifier_of(title)


def accepted(name: str) -> bool:
    NameRules("C", C_WORDS).check(name, "title")
    NameRules("Structured Text", STRUCTURED_TEXT_WORDS, ignore_case=True).check(name, "title")
    return True


#: Of ASCII, and of all letters and signs up to circled numbers; asking Hypothesis for the
#: characters of Unicode takes a second.
CHARACTERS = st.sampled_from(string.printable) | st.integers(0x80, 0x24FF).map(chr)


@given(st.lists(CHARACTERS, min_size=1).map("".join))
def test_whatever_comes_out_every_target_takes(title):
    if re.search("[A-Za-z0-9]", title):
        assert accepted(identifier_of(title))


def test_every_design_has_a_name_of_its_own():
    names = [identifier_of(title) for title in DESIGNS]
    assert len(set(names)) == len(names) and all(map(accepted, names))


def test_the_words_to_avoid_can_be_given():
    assert identifier_of("Program", frozenset()) == "program"
    assert identifier_of("Law", frozenset({"LAW"})) == "law_law"
