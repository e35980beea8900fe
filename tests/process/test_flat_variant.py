"""A variant written into its file: the same process, and no key that overrides."""

import tomllib

import pytest

from clepsydra import InputError
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.document import parse
from clepsydra.process.flat_variant import flat_text
from clepsydra.process.variants import choose_variants


def text_of(name: str) -> str:
    return catalogue_file(name).read_text(encoding="utf-8")


CASES = [
    (name, variants)
    for name in catalogue_names()
    for known in [tuple(tomllib.loads(text_of(name)).get("variants", ()))]
    for variants in [*((one,) for one in known), *([known] if len(known) > 1 else [])]
]


@pytest.mark.parametrize(("name", "variants"), CASES, ids=str)
def test_the_flat_file_says_what_the_variants_say(name, variants):
    text = text_of(name)
    flat = flat_text(text, name, variants)
    assert (
        tomllib.loads(flat) == choose_variants(parse(text.encode(), name), variants).document.tables
    )
    assert "variants" not in tomllib.loads(flat) and "default_variant" not in flat


def test_comments_stay_and_those_of_variants_go():
    flat = flat_text(text_of("laboratory-four-tanks"), "a.toml", ("volts",))
    assert "# The two lower levels follow setpoints.\n" in flat
    assert "# Ours: areas with which" not in flat
    assert 'nominal = "6.6 V"\n' in flat


def test_a_variant_that_is_not_there_is_refused():
    with pytest.raises(InputError) as caught:
        flat_text(text_of("three-tanks"), "three-tanks", ("corected",))
    assert "corrected" in caught.value.remedy
