"""The table [uncertainty] of a process file, and what it means for the values of a plant."""

import pickle
import tomllib
from pathlib import Path

import numpy as np
import pytest
from json_schema import faults
from refusals import refused

import clepsydra as cl
from clepsydra.process.distribution import Measured, Normal, Truncated, Uniform
from clepsydra.process.document import Document
from clepsydra.process.reader import load_process
from clepsydra.process.schema import process_schema
from clepsydra.process.table_reader import TableReader
from clepsydra.process.uncertainty import Uncertainty
from clepsydra.process.uncertainty_reader import read_uncertainty

VALID = (Path(__file__).parent / "plant.toml").read_text(encoding="utf-8")
BY_DEFAULT = [
    "tank_1.area", "tank_2.area", "outlet_1.area", "outlet_1.discharge", "outlet_2.area",
    "outlet_2.discharge", "pump_1.gain", "valve.tank_1", "level_1.gain",
]  # fmt: skip


@pytest.fixture
def read(tmp_path):
    """Return what reads plant.toml with a table of uncertainty."""

    def load(table, plant=VALID):
        path = tmp_path / "plant.toml"
        path.write_text(f"{plant}\n[uncertainty]\n{table}\n", encoding="utf-8")
        return load_process(path)

    return load


def from_mapping(table, process):
    """Read what has no lines, as arguments of a call."""
    return read_uncertainty(TableReader(Document("uncertainty", table, {}), (), None), process)


def spread_of(process):
    return process.uncertainty.about(process)


def test_without_a_table_every_parameter_of_an_element_varies_by_ten_percent(tmp_path):
    path = tmp_path / "plant.toml"
    path.write_text(VALID, encoding="utf-8")
    process = load_process(path)
    spread = spread_of(process)
    assert process.uncertainty == Uncertainty()
    assert list(spread.distributions) == BY_DEFAULT
    for name in BY_DEFAULT:
        value, (low, high) = process.signal(name).initial, spread.distribution(name).ends
        assert (low, high) == pytest.approx((0.9 * value, 1.1 * value), rel=1e-14)
    assert spread.factors == tuple((name,) for name in BY_DEFAULT)


def test_the_most_special_entry_counts(read):
    spread = spread_of(read('default = "0 %"\ntank_2 = "4 %"\noutlet_1 = "3 %"\n'
                            '"outlet_1.area" = "2 %"\ngravity = "1 %"'))  # fmt: skip
    assert {name: spread.words(name) for name in spread.distributions} == {
        "tank_2.area": "uniform within 4 %, 30.72 to 33.28 cm²",
        "outlet_1.area": "uniform within 2 %, 0.06958 to 0.07242 cm²",
        "outlet_1.discharge": "uniform within 3 %, 0.97 to 1.03",
        "gravity": "uniform within 1 %, 9.712 to 9.908 m/s²",
    }


def test_zero_percent_holds_one_parameter(read):
    spread = spread_of(read('"level_1.gain" = "0 %"'))
    assert list(spread.distributions) == BY_DEFAULT[:-1]


def test_dotted_keys_are_names(read):
    quoted = read('"tank_1.area" = "5 %"\n"outlet_1.area" = { within = "0.01 cm^2" }')
    dotted = read('tank_1.area = "5 %"\n[uncertainty.outlet_1]\narea = { within = "0.01 cm^2" }')
    assert quoted.uncertainty == dotted.uncertainty
    assert len(quoted.uncertainty.named) == 2


def test_names_of_elements_may_be_those_of_keys(read):
    """A splitter to a tank that is called `to` has a parameter of that name."""
    plant = VALID.replace("tank_1", "to")
    spread = spread_of(read('default = "0 %"\nvalve.to = "5 %"', plant))
    assert spread.factors == (("valve.to",),)
    spread = spread_of(read('default = "0 %"\nvalve = { within = "5 %" }', plant))
    assert spread.factors == (("valve.to",),)


@pytest.mark.parametrize(
    ("entry", "distribution"),
    [
        ('{ within = "7 cm^2" }', Uniform(0.0021, 0.0035)),
        ('{ from = "20 cm^2", to = "0.4 dm^2" }', Uniform(0.0020, 0.0040)),
        ('{ distribution = "uniform", within = "25 %" }', Uniform(0.0021, 0.0035)),
        ('{ distribution = "normal", deviation = "2 cm^2" }', Normal(0.0028, 0.0002)),
        ('{ distribution = "normal", deviation = "10 %" }', Normal(0.0028, 0.00028)),
        ('{ distribution = "normal", deviation = "30 %" }',
         Truncated(Normal(0.0028, 0.00084), 0.0, float("inf"))),
        ('{ values = ["30 cm^2", "20 cm^2"], weights = [3, 1] }',
         Measured((0.002, 0.003), (0.25, 0.75))),
    ],
)  # fmt: skip
def test_distributions_in_the_file(read, entry, distribution):
    found = spread_of(read(f'"tank_1.area" = {entry}')).distribution("tank_1.area")
    assert type(found) is type(distribution)
    numbers = np.array([0.001, 0.2, 0.6, 0.999])
    assert found.quantile(numbers) == pytest.approx(distribution.quantile(numbers), rel=1e-14)
    assert found.ends == pytest.approx(distribution.ends, rel=1e-14)


def test_only_the_default_leaves_out_what_cannot_be(read):
    plant = VALID.replace('tank_1 = 0.7, tank_2 = "30 %"', "tank_1 = 0.95, tank_2 = 0.05")
    by_default = spread_of(read('default = "10 %"', plant)).distribution("valve.tank_1")
    assert by_default.ends == (pytest.approx(0.855, rel=1e-15), 1.0)
    normal = 'default = { distribution = "normal", deviation = "10 %" }'
    assert spread_of(read(normal, plant)).distribution("valve.tank_1").ends == (0.0, 1.0)
    for entry in ('"valve.tank_1" = "10 %"', 'valve = "10 %"'):
        with refused(place="line 54", expected="from 0 to 1"):
            read(entry, plant)


def test_an_end_on_the_range_is_within_it_however_it_rounds(read):
    assert 3e-6 + 0.2 * 3e-6 > 3.6e-6
    plant = VALID.replace('nominal = "0 cm^3/s"', 'nominal = "3 cm^3/s"')
    plant = plant.replace('["0 cm^3/s", "5 cm^3/s"]', '["0 cm^3/s", "3.6 cm^3/s"]')
    plant = plant.replace('step = "1.5 cm^3/s"', 'step = "0.5 cm^3/s"')
    found = spread_of(read('inflow_1 = "20 %"', plant)).distribution("inflow_1")
    assert found.ends == (2.4e-6, 3.6e-6)
    with refused(expected="from 0 to 3.6 cm^3/s"):
        read('inflow_1 = "20.001 %"', plant)


def test_a_disturbance_varies_if_it_is_named(read):
    plant = VALID.replace('nominal = "0 cm^3/s"', 'nominal = "2 cm^3/s"')
    spread = spread_of(read('default = "0 %"\ninflow_1 = "20 %"', plant))
    assert spread.words("inflow_1") == "uniform within 20 %, 1.6 to 2.4 cm³/s"
    spread = spread_of(read('default = "0 %"\ninflow_1 = { from = "10 %", to = "50 %" }', plant))
    assert spread.distribution("inflow_1").ends == pytest.approx((0.5e-6, 2.5e-6))


def test_zeros_stay_under_what_is_said_of_many():
    """The low end of a sensor that begins at the floor has no share."""
    process = load_process("laboratory-four-tanks")
    assert process.signal("level_1.zero").initial == 0.0
    assert "level_1.zero" not in spread_of(process).distributions
    spread = from_mapping({"level_1": "5 %"}, process).about(process)
    assert "level_1.zero" not in spread.distributions and "level_1.gain" in spread.distributions
    with refused(value="5 %", expected="which is 0", remedy="from"):
        from_mapping({"level_1.zero": "5 %"}, process)
    read = from_mapping({"level_1.zero": {"within": "1 mm"}}, process)
    found = read.about(process).distribution("level_1.zero")
    assert found.ends == (-0.001, 0.001)


def test_what_varies_together_is_one_factor(read):
    process = read(
        'default = "0 %"\npump_1.gain = "3 %"\ntank_1.area = "2 %"\n'
        'tank_2.area = { same_as = "tank_1.area" }\n'
        'outlet_2.area = { same_as = "tank_2.area" }\noutlet_1.area = "5 %"\n'
        "[[uncertainty.correlated]]\n"
        'parameters = ["pump_1.gain", "tank_1.area"]\ncorrelation = 0.5'
    )
    spread = spread_of(process)
    assert spread.streams == ("tank_1.area", "outlet_1.area", "pump_1.gain")
    assert spread.factors == (
        ("tank_1.area", "tank_2.area", "outlet_2.area", "pump_1.gain"),
        ("outlet_1.area",),
    )
    assert sorted(map(sorted, spread.rows)) == [[0, 2], [1]]
    # The same share, over however many it is told.
    assert spread.distribution("outlet_2.area").ends == pytest.approx(
        (0.98 * 5.7e-6, 1.02 * 5.7e-6)
    )


def test_the_same_share_of_what_is_in_a_unit(read):
    process = read('pump_1.gain = { from = "3 cm^3/(s V)", to = "4 cm^3/(s V)" }\n'
                   'tank_1.area = { same_as = "pump_1.gain" }')  # fmt: skip
    ends = spread_of(process).distribution("tank_1.area").ends
    assert ends == pytest.approx((28e-4 * 3 / 3.33, 28e-4 * 4 / 3.33), rel=1e-14)


def test_correlations_as_a_number_and_as_a_matrix(read):
    names = 'parameters = ["tank_1.area", "tank_2.area", "pump_1.gain"]'
    one = read(f"[[uncertainty.correlated]]\n{names}\ncorrelation = -0.3")
    rows = "[[1, -0.3, -0.3], [-0.3, 1, -0.3], [-0.3, -0.3, 1]]"
    other = read(f"[[uncertainty.correlated]]\n{names}\ncorrelation = {rows}")
    assert one.uncertainty == other.uncertainty
    (group,) = spread_of(one).roots
    assert group[1] @ group[1].T == pytest.approx(np.array(tomllib.loads(f"a = {rows}")["a"]))


def test_other_values_have_the_distributions_about_them():
    plant = cl.load("quadruple-tank")
    bigger = plant.with_values({"tank_1.area": "56 cm^2"})
    assert spread_of(bigger.process).words("tank_1.area") == "uniform within 10 %, 50.4 to 61.6 cm²"
    assert bigger.process.uncertainty == plant.process.uncertainty
    drawn = cl.load("quadruple-tank#3").process
    middle = sum(spread_of(drawn).distribution("outlet_1.area").ends) / 2
    assert middle == pytest.approx(drawn.signal("outlet_1.area").initial, rel=1e-14)


def test_what_other_values_contradict_is_refused_where_it_is_asked(read):
    process = read('"valve.tank_1" = "10 %"')
    plant = cl.Plant(process).with_values({"valve.tank_1": 0.95})
    with refused(place="line 54, uncertainty.valve.tank_1", expected="from 0 to 1"):
        spread_of(plant.process)


def test_a_correlated_parameter_that_stands_leaves_its_group(read):
    process = read(
        "[[uncertainty.correlated]]\n"
        'parameters = ["tank_1.area", "outlet_1.discharge", "tank_2.area"]\n'
        "correlation = [[1, 0.1, 0.2], [0.1, 1, 0.3], [0.2, 0.3, 1]]\n"
        "[[uncertainty.correlated]]\n"
        'parameters = ["outlet_2.discharge", "valve.tank_1"]\ncorrelation = 0.5'
    )
    values = {"outlet_1.discharge": 0.0, "outlet_2.discharge": 0.0, "valve.tank_1": 0.0}
    spread = spread_of(cl.Plant(process).with_values(values).process)
    assert spread.factors[0] == ("tank_1.area", "tank_2.area")
    ((rows, root),) = spread.roots
    assert rows == (0, 1) and root @ root.T == pytest.approx(np.array([[1, 0.2], [0.2, 1]]))


def test_processes_are_told_apart_by_their_uncertainty(read):
    one, same, other = read('tank_1 = "5 %"'), read('\ntank_1 = "5 %"'), read('tank_1 = "6 %"')
    assert one.uncertainty == same.uncertainty != other.uncertainty
    assert pickle.loads(pickle.dumps(one)).uncertainty == one.uncertainty
    spread = spread_of(one)
    assert spread.factors and pickle.loads(pickle.dumps(spread)).factors == spread.factors


def test_a_variant_has_an_uncertainty_of_its_own(read):
    process = read('tank_1 = "5 %"\n[variants.worn]\nuncertainty.tank_1 = "20 %"')
    assert spread_of(process).words("tank_1.area").startswith("uniform within 5 %")
    worn = load_process(process.path, "worn")
    assert spread_of(worn).words("tank_1.area").startswith("uniform within 20 %")


def test_a_mapping_says_the_same(read):
    text = (
        'default = "3 %"\n"pump_1.gain" = { distribution = "normal", deviation = 0.03 }\n'
        'tank_2 = "5 %"\n[[uncertainty.correlated]]\nparameters = ["tank_1.area", "pump_1.gain"]\n'
        "correlation = 0.5"
    )
    process = read(text.replace("0.03", '"3 %"'))
    table = {
        "default": 0.03,
        "pump_1.gain": {"distribution": "normal", "deviation": "3 %"},
        "tank_2": "5 %",
        "correlated": [{"parameters": ["tank_1.area", "pump_1.gain"], "correlation": 0.5}],
    }
    assert from_mapping(table, process) == process.uncertainty
    with refused(place="uncertainty, line 1, tank_1.aera", remedy="tank_1.area"):
        from_mapping({"tank_1.aera": "5 %"}, process)
    with refused(
        place="uncertainty, line 1, tank_1.area.deviation", value="2 V", expected="in cm^2"
    ):
        entry = {"distribution": "normal", "deviation": "2 V"}
        from_mapping({"tank_1.area": entry}, process)


@pytest.mark.parametrize(
    ("table", "wrong"),
    [
        ({"default": "10 %", "tank_1.area": "5 %", "tank_1": {"area": {"within": "1 cm^2"}}}, 0),
        ({"default": {"distribution": "log-normal", "deviation": "3 %"}}, 0),
        ({"correlated": [{"parameters": ["a", "b"], "correlation": 0.3}]}, 0),
        ({"correlated": [{"parameters": ["a", "b"]}]}, 1),
        ({"default": {"distribution": "gaussian"}}, 1),
        ({"default": True}, 1),
        ({"tank_1.area": True}, 1),
    ],
)
def test_what_an_editor_is_told(table, wrong):
    assert bool(list(faults(table, process_schema()["properties"]["uncertainty"]))) == wrong
