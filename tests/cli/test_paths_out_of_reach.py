"""A path that the system does not let anybody look at ends in a message, whoever names it."""

import pytest

RECORD = "time [s],pump_1 [V],level_1 [cm]\n" + "".join(
    f"{t},{3 + (t > 20)},{10 + 0.01 * max(t - 20, 0)}\n" for t in range(0, 200, 2)
)
LONG = "x" * 300
STUDY = 'process = "quadruple-tank"\n[controllers.own]\n'
IN_STUDIES = {
    "process": 'process = "{path}.toml"\n[controllers.pi]\ndesign = "simc"\n',
    "fuzzy": STUDY + 'fuzzy = "{path}.toml"\n',
    "regulator": STUDY + 'regulator = "{path}.mat"\n',
    "law": STUDY + 'law = "{path}.py"\n',
}
OUTPUTS = {
    "analyse": ("analyse", "quadruple-tank", "-o", "{path}.html"),
    "draw": ("draw", "quadruple-tank", "-o", "{path}.svg"),
    "simulate": ("simulate", "quadruple-tank", "-o", "{path}"),
    "study": ("study", "quadruple-tank", "-o", "{path}"),
    "export": ("export", "quadruple-tank", "--controller", "PI, SIMC", "--to", "c", "-o", "{path}"),
    "verify": ("verify", "quadruple-tank", "-o", "{path}"),
    "papers": ("papers", "-o", "{path}"),
    "identify": ("identify", "record.csv", "-o", "{path}"),
}
INPUTS = {
    "analyse": ("analyse", "{path}.toml"),
    "analyse a name": ("analyse", "{path}"),
    "draw": ("draw", "{path}.toml"),
    "simulate": ("simulate", "{path}.toml"),
    "study": ("study", "{path}.toml"),
    "export": ("export", "{path}.toml", "--to", "c"),
    "verify": ("verify", "{path}.toml"),
    "identify": ("identify", "{path}.csv"),
    "identify --process": (
        "identify", "record.csv", "--process", "{path}.toml", "--parameters", "tank_1.area",
    ),
    "new --process": ("new", "mine", "--study", "--process", "{path}.toml"),
}  # fmt: skip
OUT_OF_REACH = {LONG: "file name too long", "forbidden/own": "permission denied"}


@pytest.fixture(params=OUT_OF_REACH, ids=OUT_OF_REACH.values())
def path(request, tmp_path, forbidden):
    """Return a path that cannot be looked at, from the folder of the test."""
    forbidden(tmp_path / "forbidden")
    return request.param


@pytest.fixture
def ends(command, tmp_path):
    """Return a function: arguments and a reason → the one message that it ends with."""
    (tmp_path / "record.csv").write_text(RECORD)

    def run(arguments, path):
        before = sorted(tmp_path.iterdir())
        status, output, errors = command(*(each.format(path=path) for each in arguments))
        assert (status, output) == (2, ""), errors
        assert errors.startswith("clepsydra: ") and OUT_OF_REACH[path] in errors
        assert sorted(tmp_path.iterdir()) == before
        return errors.removeprefix("clepsydra: ")

    return run


@pytest.mark.parametrize("key", IN_STUDIES)
def test_keys_of_a_study_file(ends, tmp_path, path, key):
    (tmp_path / "s.toml").write_text(IN_STUDIES[key].format(path=path))
    said = ends(("study", "s.toml", "--json"), path)
    assert said.startswith("s.toml, line ")
    assert said.partition(": got ")[0].endswith(key) and f": got '{path[:50]}" in said


@pytest.mark.parametrize("verb", OUTPUTS)
def test_where_results_go(ends, path, verb):
    assert ends(OUTPUTS[verb], path).startswith("--output: got ")


@pytest.mark.parametrize("verb", INPUTS)
def test_what_is_read(ends, path, verb):
    ends(INPUTS[verb], path)


def test_elements_of_a_process_file(ends, tmp_path):
    (tmp_path / "own.toml").write_text(f'name = "own"\nelements = "{LONG}.py"\n')
    said = ends(("analyse", "own.toml"), LONG)
    assert said.startswith("own.toml, line 2, elements: got 'xxx")


def test_a_record_whose_page_would_have_too_long_a_name(ends, tmp_path):
    (tmp_path / f"{'r' * 240}.csv").write_text(RECORD)
    said = ends(("identify", f"{'r' * 240}.csv", "-o", "."), LONG)
    assert said.startswith("--output: got ")
