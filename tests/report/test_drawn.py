"""Every drawing can be read: geometry of the picture, with and without controllers."""

import pytest
from drawn import box_of, check
from drawn_plants import CHAINS, FILES, PLANTS, loaded
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.exported.families import FAMILIES, ready_for_export
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.linear.equilibrium import NoEquilibrium, find_equilibrium
from clepsydra.process.catalogue_names import catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.report.drawing.flow_graph import flow_graph
from clepsydra.report.drawing.plant import process_drawing

ADDRESSES = [
    address
    for name in catalogue_names()
    for address in (name, *(f"{name}:{variant}" for variant in load_process(name).variants))
]
#: In the fast tier: crossings, vessels of each shape, one law for several outputs, a scheme.
SHORT = ["quadruple-tank", "many-shapes", "LQI, Bryson", "Split range"]


def every(names):
    return [
        name if name in SHORT else pytest.param(name, marks=pytest.mark.thorough) for name in names
    ]


def at_rest(process):
    try:
        return find_equilibrium(process)
    except NoEquilibrium:
        return None


def loops(process):
    """PI loops from each controlled measurement to an input."""
    pairs = list(zip(process.controlled, [s.name for s in process.inputs], strict=False))
    controlled, moved = (tuple(names) for names in zip(*pairs, strict=True))
    law = multiloop_pid_law(controlled, moved)
    values = {p.name: float(p.part != "low_limit") for p in law.parameters}
    state = {signal.name: 0.0 for signal in law.state}
    return Controller("PI", "", "", law, values, state, controlled, controlled, moved)


@pytest.mark.parametrize("name", every([*ADDRESSES, *PLANTS, *CHAINS, *FILES]))
def test_a_process_can_be_read_with_its_loops_open_and_closed(name, tmp_path):
    process = loaded(name, tmp_path)
    point = at_rest(process)
    assert not check(process_drawing(process, point)).lines["signal"]
    closed = check(process_drawing(process, point, loops(process)))
    # From each transmitter to its controller, and on to the actuator.
    assert len(closed.lines["signal"]) == 2 * min(len(process.controlled), len(process.inputs))


@pytest.mark.parametrize("name", every(FAMILIES))
def test_the_loops_of_every_kind_of_controller_can_be_read(name):
    controller, point = ready_for_export(name).controller, at_rest(load_process(FAMILIES[name]))
    drawn = check(process_drawing(point.process, point, controller))
    ends = [line[0].split(" to ") for line in drawn.lines["signal"]]
    owner = flow_graph(point.process).owner
    assert {owner(name) for name in controller.manipulated} <= {end for _, end in ends}
    assert {start for start, _ in ends} >= {owner(name) for name in controller.setpoints}


def test_the_line_of_a_meter_beside_a_level_valve_reaches_its_pipe():
    lines = check(process_drawing(load_process(FILES["valves"]), None)).lines
    ((x, y),) = (pieces[0][0] for title, pieces, _ in lines["tap"] if "cross_valve" in title)
    boxes = [box_of(piece) for _, pieces, _ in lines["pipe"] for piece in pieces]
    assert any(left <= x <= right and top <= y <= bottom for left, top, right, bottom in boxes)


def test_a_concentration_that_is_moved_in_a_reservoir_has_its_signal(tmp_path):
    path = tmp_path / "brine.toml"
    path.write_text(
        """
name = "brine"
sampling_period = "1 s"
manipulated = ["feed", "basin.salt"]
controlled = ["level", "salinity"]
components.salt.range = ["0 g/l", "50 g/l"]
[reservoirs.basin]
concentration = { salt = { range = ["0 g/l", "50 g/l"], nominal = "10 g/l" } }
[reservoirs.drain]
[tanks.vessel]
area = "1 m^2"
height = "1 m"
[sensors.level]
tank = "vessel"
range = ["0 m", "1 m"]
[sensors.salinity]
tank = "vessel"
component = "salt"
range = ["0 g/l", "50 g/l"]
[orifices.hole]
source = "vessel"
destination = "drain"
area = "10 cm^2"
[pumps.feed]
source = "basin"
destination = "vessel"
gain = "1 l/(s V)"
range = ["0 V", "10 V"]
nominal = "2 V"
""",
        encoding="utf-8",
    )
    process = load_process(path)
    drawn = check(process_drawing(process, at_rest(process), loops(process)))
    assert "loop salinity to basin" in [line[0] for line in drawn.lines["signal"]]


@st.composite
def plants(draw):
    """A process file with tanks, orifices, pumps and meters between them."""
    names = st.from_regex(r"t(_?[abcdeghmw]){1,8}", fullmatch=True)
    tanks = draw(st.lists(names, min_size=1, max_size=6, unique=True))
    pumped = draw(st.lists(st.sampled_from(tanks), min_size=1, max_size=3))
    controlled = draw(
        st.lists(st.sampled_from(tanks), min_size=1, max_size=len(pumped), unique=True)
    )
    lines = ['name = "plant"', 'sampling_period = "1 s"']
    lines += [f"controlled = {[f's0{tank}' for tank in controlled]}", "[reservoirs.basin]"]
    for place, tank in enumerate(tanks):
        lines += [f"[tanks.{tank}]", 'area = "100 cm^2"', 'height = "50 cm"']
        for number in range(draw(st.integers(1, 2))):
            lines += [f"[sensors.s{number}{tank}]", f'tank = "{tank}"']
            lines.append('range = ["0 cm", "50 cm"]')
        below = draw(st.sampled_from(["basin", *tanks[place + 1 :]]))
        lines += [f"[orifices.o{tank}]", f'source = "{tank}"', f'destination = "{below}"']
        lines.append('area = "4 cm^2"')
        if draw(st.booleans()):
            lines += [f"[sensors.f{tank}]", f'flow = "o{tank}"', 'lag = "1 s"']
            lines.append('range = ["0 l/s", "5 l/s"]')
    for number, tank in enumerate(pumped):
        lines += [f"[pumps.pump_{number}]", 'source = "basin"', f'destination = "{tank}"']
        lines += ['gain = "15 cm^3/(s V)"', 'range = ["0 V", "10 V"]', 'nominal = "3 V"']
        if draw(st.booleans()):
            lines.append(f'tag = "P10{number}"')
    return "\n".join(lines) + "\n"


@pytest.mark.thorough
@settings(max_examples=60, deadline=None, derandomize=True)
@given(text=plants())
def test_any_plant_can_be_read(text, tmp_path_factory):
    path = tmp_path_factory.mktemp("plant") / "plant.toml"
    path.write_text(text, encoding="utf-8")
    process = load_process(path)
    check(process_drawing(process, None))
    check(process_drawing(process, at_rest(process), loops(process)))
