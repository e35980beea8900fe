"""The line of every key, in every way that TOML allows to write one."""

import random
import tomllib

from clepsydra.process.toml_lines import key_lines, line_of

TEXT = '''# a comment with [brackets] and "quotes"

title = "plant" # = [x]
[ tanks . "tank one" ]  # header with blanks and a quoted key
area = "28 cm^2"
'odd "key"' = 1
range = [
  "0 V",  # ] in a comment
  "10 V", '] in a string',
]
text = """
[not.a.table]
key = 1
""\\"" """""
after = \'\'\'
[neither]
\'\'\'
inner = { first = [1, 2], second = { third = "}" } }
dotted.key.path = 1
"escaped \\u0061" = 2

[[ array ]]
one = 1
[[array]]
two = 2
[array.inner]
three = 3
[[array.deep]]
[[array.deep]]
[last]
'''


def test_lines() -> None:
    lines = key_lines(TEXT)
    tank = ("tanks", "tank one")
    expected = {
        ("title",): 3,
        ("tanks",): 4,
        tank: 4,
        (*tank, "area"): 5,
        (*tank, 'odd "key"'): 6,
        (*tank, "range"): 7,
        (*tank, "text"): 11,
        (*tank, "after"): 15,
        (*tank, "inner"): 18,
        (*tank, "dotted"): 19,
        (*tank, "dotted", "key"): 19,
        (*tank, "dotted", "key", "path"): 19,
        (*tank, "escaped a"): 20,
        ("array",): 22,
        ("array", "1"): 22,
        ("array", "1", "one"): 23,
        ("array", "2"): 24,
        ("array", "2", "two"): 25,
        ("array", "2", "inner"): 26,
        ("array", "2", "inner", "three"): 27,
        ("array", "2", "deep"): 28,
        ("array", "2", "deep", "1"): 28,
        ("array", "2", "deep", "2"): 29,
        ("last",): 30,
    }
    assert lines == expected
    assert line_of(lines, (*tank, "inner", "second", "third")) == 18
    assert line_of(lines, ("missing",)) == 1
    # The text is what the standard library takes it for.
    assert set(tomllib.loads(TEXT)["tanks"]["tank one"]) == {
        path[2] for path in expected if path[:2] == tank and len(path) == 3
    }


def test_every_key_of_random_files_is_found_on_its_line() -> None:
    """Files put together at random from all kinds of values; the true line is counted."""
    generator = random.Random(5)
    values = [
        '"a # [b"',
        "'''x\n[y]\n'''",
        "[1,\n 2, # ]\n 3]",
        "{ a = 1 }",
        '"""\n\\"" [z] """',
        "1",
    ]
    gaps = ["", "\n", "# note = 1\n", "  \t\n\n"]
    for _ in range(300):
        text, expected = "", {}
        for table in range(generator.randint(0, 3)):
            text += generator.choice(gaps)
            expected[(f"t{table}",)] = text.count("\n") + 1
            text += f"[t{table}]\n"
            for key in range(generator.randint(0, 4)):
                text += generator.choice(gaps)
                expected[(f"t{table}", f"k{key}")] = text.count("\n") + 1
                text += f"k{key} = {generator.choice(values)}\n"
        tomllib.loads(text)
        assert key_lines(text) == expected


def test_text_without_a_line_break_at_the_end() -> None:
    assert key_lines("[a]\nb = 1") == {("a",): 1, ("a", "b"): 2}
    assert key_lines("# nothing") == {}
