import re
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from pathlib import Path
from random import Random
from typing import ClassVar
from xml.etree import ElementTree

import pytest
from drawn_plants import CHAINS, FILES, PLANTS, loaded
from written_plants import plant_of

from clepsydra import Connection, Element
from clepsydra.controllers.controller import Controller
from clepsydra.controllers.pid import multiloop_pid_law
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.report.drawing.bodies import TANK_HALF, TANK_ROWS
from clepsydra.report.drawing.control_functions import ControlFunction
from clepsydra.report.drawing.flow_graph import FlowGraph, Instrument, Link, flow_graph
from clepsydra.report.drawing.outline import TANK_HEIGHT
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.drawing.routing import route
from clepsydra.report.drawing.shapes import PAPER, PIPE

SVG = "{http://www.w3.org/2000/svg}"


#: One of each: what is known from the paper, splitters in a row, a chain, every kind of vessel.
SHORT = ["quadruple-tank", "splitter behind a splitter", "8 joined", "many-shapes"]
EVERY = [
    name if name in SHORT else pytest.param(name, marks=pytest.mark.thorough)
    for name in (*catalogue_names(), *PLANTS, *CHAINS, *FILES)
]


@pytest.fixture(scope="module", params=EVERY)
def drawn(request, tmp_path_factory):
    """A process with its routes and its drawing."""
    process = loaded(request.param, tmp_path_factory.mktemp("plant"))
    labels = {element.name: (element.name, "12.34 cm") for element in process.elements}
    routes = route(flow_graph(process), labels)
    return process, routes, process_drawing(process, find_equilibrium(process))


def segments(points):
    return list(pairwise(points))


def covered(pipe):
    """The points of the grid on which a pipe lies, sideways and upright."""
    sideways, upright = set(), set()
    for (x1, y1), (x2, y2) in segments(pipe.points):
        for x in range(min(x1, x2), max(x1, x2) + 1):
            for y in range(min(y1, y2), max(y1, y2) + 1):
                (sideways if y1 == y2 else upright).add((x, y))
    return sideways, upright


def touched(routes, pipe, point):
    """The name of what a pipe meets at its end."""
    x, y = point
    for body in routes.placement.bodies.values():
        if body.symbol == "tank":
            left, top, right, floor = body.x - TANK_HALF, body.y, body.x + TANK_HALF, body.y
            floor += TANK_ROWS
            if left <= x <= right and top <= y <= floor:
                return body.name
        elif body.symbol in ("delay", "header"):
            # Pipes meet these anywhere along their length.
            left, _, right, _ = body.areas[0]
            if left <= x <= right and y == body.y:
                return body.name
        elif (x, y) == (body.x, body.y):
            return body.name
    for at, shelf, name in routes.basin_uses:
        if (x, y) == (at, routes.placement.basin_rows[shelf]):
            return name
    return ""


def check_geometry(routes):
    """See that no line runs through or along anything, and that no two parts overlap."""
    bodies = routes.placement.bodies.values()
    for pipe in routes.pipes:
        for (x1, y1), (x2, y2) in segments(pipe.points):
            assert (x1 == x2) != (y1 == y2), pipe
        sideways, upright = covered(pipe)
        ends = {pipe.source, pipe.end}
        if pipe.kind == "pipe":
            ends = {touched(routes, pipe, pipe.points[0]), touched(routes, pipe, pipe.points[-1])}
        for body in bodies:
            if body.name in ends or body.symbol == "stub" or pipe.line == body.name:
                continue
            for left, top, right, bottom in body.areas:
                for x, y in sideways | upright:
                    assert not (left <= x <= right and top <= y <= bottom), (pipe, body)
    for one, other in combinations(routes.pipes, 2):
        for along, beside in zip(covered(one), covered(other), strict=True):
            shared = along & beside
            # Two pipes may meet in the middle of what they both join, and nowhere else.
            assert not shared - {
                point for pipe in (one, other) for point in (pipe.points[0], pipe.points[-1])
            }, (one, other)
    for one, other in combinations(bodies, 2):
        for a, b, c, d in one.areas:
            for e, f, g, h in other.areas:
                apart = c <= e or g <= a or d <= f or h <= b
                assert apart or {one.symbol, other.symbol} == {"tank", "stub"}, (one, other)


def joints(routes):
    """The pairs of names that pipes join."""
    found = set()
    for pipe in (pipe for pipe in routes.pipes if pipe.kind == "pipe"):
        names = [touched(routes, pipe, point) for point in (pipe.points[0], pipe.points[-1])]
        names = [name or pipe.line for name in names]
        found |= {frozenset(names)} if len(set(names)) == 2 else set()
    return found


def test_pipes_keep_clear_of_everything(drawn):
    check_geometry(drawn[1])


def test_pipes_join_what_the_file_joins_and_nothing_else(drawn):
    process, routes, _ = drawn
    named = {
        frozenset((element.name, connection.name))
        for element in process.elements
        for connection in element.connections()
        if connection.carries_flow
    }
    assert joints(routes) == named


def test_tanks_stand_above_those_that_they_drain_into(drawn):
    process, routes, _ = drawn
    graph, bodies = flow_graph(process), routes.placement.bodies
    seats = routes.placement.seats
    for upper, lower in graph.falls():
        # A stack that is too tall goes on beside itself.
        if seats[upper].column == seats[lower].column:
            assert bodies[upper].y + TANK_ROWS < bodies[lower].y
    for one, other in graph.neighbours():
        if seats[one].shelf == seats[other].shelf:
            assert bodies[one].y == bodies[other].y


def test_the_drawing_is_well_formed_and_names_every_element(drawn):
    process, _, drawing = drawn
    root = ElementTree.fromstring(drawing)
    titles = " | ".join(title.text for title in root.iter(f"{SVG}title"))
    for element in process.elements:
        assert element.name in titles, element
    _, _, width, height = (float(number) for number in root.get("viewBox").split())
    assert width <= 1800 and height <= 1900  # so that a long chain stays readable
    for text in root.iter(f"{SVG}text"):
        reach = 7.5 * len(text.text or "")
        before = reach * {"start": 0, "middle": 0.5, "end": 1}[text.get("text-anchor")]
        assert float(text.get("x")) - before >= 0, text.text
        assert float(text.get("x")) - before + reach <= width, text.text
        assert 0 < float(text.get("y")) < height


@pytest.mark.sampled
@pytest.mark.parametrize("seed", range(20))
def test_any_plant_finds_a_drawing(seed):
    graph = random_graph(Random(seed))
    routes = route(graph, {}, random_functions(Random(seed), graph))
    check_geometry(routes)
    named = {
        frozenset((link.name, end))
        for link in graph.links
        for end in (*link.sources, *link.targets)
    }
    named |= {frozenset((j.name, end)) for j in graph.junctions for end in j.targets}
    assert joints(routes) == named


def random_graph(random):
    """Tanks, reservoirs and everything between them, joined at random."""
    tanks = [f"tank_{n}" for n in range(random.randint(1, 9))]
    basins = [f"basin_{n}" for n in range(random.randint(1, 3))]
    junctions = []
    for n in range(random.randint(0, 3)):
        known = [*tanks, *basins, *(j.name for j in junctions)]
        symbol = random.choice(["splitter", "delay"])
        count = 1 if symbol == "delay" else random.randint(2, min(6, len(known)))
        ends = random.sample(known, count)
        shares = (1 / count,) * count
        junctions.append(Link(f"junction_{n}", symbol, (), tuple(ends), shares=shares))
    links = []
    for n in range(random.randint(1, 2 * len(tanks) + 2)):
        symbol = random.choice(["orifice", "valve", "pump", "flow", "box"])
        sources = random.sample([*tanks, *basins], 1)
        ends = [e for e in (*tanks, *basins, *(j.name for j in junctions)) if e not in sources]
        targets = random.sample(ends, 1)
        if symbol == "flow":
            sources, targets = random.choice([(sources, ()), ((), targets), (sources, targets)])
        elif symbol == "orifice" and sources and sources[0] in basins:
            continue
        held = bool(sources) and sources[0] in tanks
        joined = symbol in ("orifice", "valve") and targets[0] in tanks and random.random() < 0.4
        links.append(
            Link(f"link_{n}", symbol, tuple(sources), tuple(targets), submerged=held and joined,
                 by_weight=held and symbol not in ("pump", "flow"))
        )  # fmt: skip
    fed = {end for link in links for end in link.targets}
    for number, junction in enumerate(junctions):
        fed |= set(junction.targets)
        if junction.name not in fed:
            links.append(Link(f"feed_{number}", "pump", (basins[0],), (junction.name,)))
    meters = [random.choice([*tanks, *(link.name for link in links)]) for _ in range(4)]
    return FlowGraph(
        tuple(tanks), tuple(links), tuple(junctions),
        tuple(Instrument(f"meter_{n}", "L", seat, str(101 + n)) for n, seat in enumerate(meters)),
    )  # fmt: skip


def test_a_signal_reaches_whatever_has_an_input():
    links = (
        Link("pump", "pump", ("basin",), ("split",)),
        Link("fall", "orifice", ("upper",), ("lower",), by_weight=True),
        Link("out", "orifice", ("lower",), ("basin",), by_weight=True),
    )
    split = Link("split", "splitter", (), ("upper", "lower"), shares=(0.5, 0.5))
    meter = Instrument("meter", "L", "lower", "101")
    graph = FlowGraph(("upper", "lower"), links, (split,), (meter,), ("heater",))
    for end in ("pump", "fall", "split", "upper", "basin", "heater"):
        routes = route(graph, {}, [ControlFunction("loop", "", "meter", ("meter",), (end,))])
        check_geometry(routes)
        signals = {(pipe.source, pipe.end) for pipe in routes.pipes if pipe.kind == "signal"}
        assert signals == {("meter", "loop"), ("loop", end)}


def random_functions(random, graph):
    """Controllers of some meters that move some pumps, valves and flows."""
    actuators = [link.name for link in graph.links if link.symbol in ("pump", "valve", "flow")]
    meters = [instrument.name for instrument in graph.instruments]
    random.shuffle(actuators)
    kind = random.choice(["loops", "several", "sum"])
    if kind == "several":
        return [ControlFunction("law", "", "", tuple(meters), tuple(actuators[:3]))]
    loops = []
    for meter, actuator in zip(meters, actuators[:2], strict=False):
        gives = (actuator,) if kind == "loops" else ()
        loops.append(ControlFunction(f"loop {meter}", "", meter, (meter,), gives, f"{meter}.sp"))
        if kind == "sum":
            reads = (f"loop {meter}", meters[-1])
            loops.append(ControlFunction(f"sum {meter}", "Σ", "", reads, (actuator,)))
    return loops


@pytest.mark.parametrize(
    "name",
    [
        "quadruple-tank",
        pytest.param("quadruple-tank-nonminimum-phase", marks=pytest.mark.thorough),
    ],
)
def test_the_quadruple_tank_looks_like_the_picture_in_the_paper(name):
    process = load_process(name)
    bodies = route(flow_graph(process), {}).placement.bodies
    tanks = [bodies[f"tank_{number}"] for number in (1, 2, 3, 4)]
    assert tanks[0].x == tanks[2].x < tanks[1].x == tanks[3].x
    assert tanks[2].y == tanks[3].y < tanks[0].y == tanks[1].y
    assert bodies["pump_1"].x < tanks[0].x - TANK_HALF
    assert bodies["pump_2"].x > tanks[1].x + TANK_HALF
    # The diagonal pipes have to cross once, and nothing else does.
    assert process_drawing(process, find_equilibrium(process)).count("a6 6 0 0 ") == 1


def heights(path):
    """The greatest and the least y of a closed path."""
    ys = [float(pair.split()[1]) for pair in path.get("d").strip("MZ").split("L")]
    return max(ys), min(ys)


@pytest.fixture(scope="module")
def shapes():
    """The drawing of vessels of every shape, and where they rest."""
    process = load_process(FILES["many-shapes"])
    point = find_equilibrium(process)
    return process_drawing(process, point), point


def test_water_stands_at_the_scale_of_its_tank(shapes):
    drawing, point = shapes
    process = point.process
    root = ElementTree.fromstring(drawing)
    for signal in process.state:
        if not signal.name.endswith(".level"):
            continue
        (group,) = [
            entry
            for entry in root.iter(f"{SVG}g")
            if entry[0].tag == f"{SVG}title"
            and entry[0].text.startswith(f"{signal.name[:-6]}: level ")
        ]
        (water,) = [path for path in group.findall(f"{SVG}path") if path.get("class") == "water"]
        floor, surface = heights(water)
        share = (floor - surface) / TANK_HEIGHT
        level = point.as_dict()[signal.name]
        assert share == pytest.approx(level / signal.high, abs=0.15 / TANK_HEIGHT)


def widest(drawing, tank):
    """The width of the outline of a tank at its rim, half-way and at its floor."""
    root = ElementTree.fromstring(drawing)
    group = next(g for g in root.iter(f"{SVG}g") if (g[0].text or "").startswith(f"{tank}: level "))
    pairs = group.find(f"{SVG}path").get("d").strip("MZ").split("L")
    points = [tuple(float(n) for n in pair.split()) for pair in pairs]
    rim, floor = min(y for _, y in points), max(y for _, y in points)
    widths = []
    for height in (rim, (rim + floor) / 2, floor):
        near = min(abs(y - height) for _, y in points)
        xs = [x for x, y in points if abs(y - height) <= near + 1e-9]
        widths.append(max(xs) - min(xs))
    return widths


def test_vessels_have_the_profile_of_their_shape(shapes):
    drawing, _ = shapes
    full = 2 * TANK_HALF * 16.0
    # Diameters of 1.2 m at the rim and 0.2 m at the floor.
    assert widest(drawing, "funnel") == pytest.approx([full, full * 0.7 / 1.2, full / 6], abs=2.5)
    # A sphere: its poles are points.
    assert widest(drawing, "ball") == pytest.approx([0.0, full, 0.0], abs=0.1)
    # Areas of 2.2 m² at the rim and 0.4 m² at the floor.
    rim, _, floor = widest(drawing, "pond")
    assert rim == full and floor == pytest.approx(full * (0.4 / 2.2) ** 0.5, abs=0.2)


def test_a_tank_with_a_weir_shows_it_and_others_do_not(shapes):
    assert re.findall("<title>weir of ([a-z_]*)</title>", shapes[0]) == ["pond"]


def test_a_delay_says_how_long_it_is(shapes):
    assert "<title>transport delay channel, τ = 60 s</title>" in shapes[0]


def test_what_a_reader_is_to_find_is_not_told(shapes):
    _, point = shapes
    drawing = process_drawing(point.process, point, hides=["channel.time"])
    assert "60 s" in shapes[0]
    assert "60 s" not in drawing
    assert "<title>transport delay channel, τ</title>" in drawing
    tanks = load_process("quadruple-tank")
    own = process_drawing(tanks, find_equilibrium(tanks))
    hidden = process_drawing(tanks, find_equilibrium(tanks), hides=["splitter_1.tank_1"])
    assert "70 %" in own and "70 %" not in hidden
    # Neither what the other pipe gets.
    assert hidden.count("30 %") < own.count("30 %")
    assert "60 %" in hidden


def test_a_concentration_in_a_tank_has_its_whole_name_and_its_value():
    process = load_process("averaging-tank")
    root = ElementTree.fromstring(process_drawing(process, find_equilibrium(process)))
    words = {
        element.text: float(element.get("y", ""))
        for element in root.iter()
        if element.tag.endswith("text") and element.text
    }
    values = [float(e.get("y", "")) for e in root.iter() if e.text == "5.00 kmol/m³"]
    assert words["tank"] < words["2.00 m"] < words["50.0 %"] < words["impurity"]
    assert words["impurity"] + 16.0 in values


def test_a_plant_without_an_operating_point_is_drawn_without_values():
    process = load_process(FILES["valves"])
    drawing = process_drawing(process, None)
    words = [text.text for text in ElementTree.fromstring(drawing).iter(f"{SVG}text")]
    assert {"drop_valve", "upper", "flow_main"} <= set(words)
    assert not [word for word in words if word and re.search(r"\d\.\d", word)]


def test_instruments_have_the_letters_of_what_they_measure():
    process = load_process(FILES["valves"])
    controlled, moved = process.controlled, ("drop_valve", "fill_valve")
    law = multiloop_pid_law(controlled, moved)
    values = {p.name: float(p.part != "low_limit") for p in law.parameters}
    state = {signal.name: 0.0 for signal in law.state}
    by_hand = Controller("PI", "", "", law, values, state, controlled, controlled, moved)
    drawing = process_drawing(process, None, by_hand)
    titles = re.findall("<title>([A-Z]+)-[0-9]+: ([a-z_ ]*)", drawing)
    found = {(letters, words.split()[1 if "C" in letters else 0]) for letters, words in titles}
    assert found == {
        ("FT", "flow_main"), ("FIC", "flow_main"), ("FT", "flow_cross"), ("FT", "flow_out"),
        ("LT", "level_c"), ("LIC", "level_c"), ("AT", "salt_c"),
    }  # fmt: skip


def test_an_instrument_that_is_called_by_a_tag_has_its_number():
    process = load_process(Path(__file__).parents[2] / "docs" / "examples" / "hotwell.toml")
    (instrument,) = flow_graph(process).instruments
    assert (instrument.letter, instrument.number) == ("L", "201")


def test_a_pump_points_where_it_delivers():
    # From the well down to the works, so not upward as from a reservoir.
    process = load_process("wet-well")
    drawing = process_drawing(process, None)
    bodies = route(flow_graph(process), {}).placement.bodies
    assert bodies["standby"].y > bodies["well"].y
    # A pump is drawn as it delivers upward, and turned half round.
    turned = r'rotate\(180\)"><title>pump standby</title><circle[^>]*/><path d="M([^Z]*)Z'
    path = re.search(turned, drawing)
    corners = [tuple(float(n) for n in pair.split()) for pair in path.group(1).split("L")]
    (_, left), (_, tip), (_, right) = corners
    assert left == right > tip


@dataclass(frozen=True)
class Clarifier(Element):
    """A vessel of a kind that Clepsydra does not know."""

    kind: ClassVar[str] = "clarifier"
    table: ClassVar[str] = "clarifiers"
    keys: ClassVar[tuple[str, ...]] = ()
    receives: ClassVar[bool] = True
    gives: ClassVar[bool] = True

    @classmethod
    def read(cls, name, table):
        return cls(name)


@dataclass(frozen=True)
class Siphon(Clarifier):
    """A flow between two places of a kind that Clepsydra does not know."""

    kind: ClassVar[str] = "siphon"
    table: ClassVar[str] = "siphons"
    receives: ClassVar[bool] = False
    gives: ClassVar[bool] = False
    ends: tuple[str, str] = ("", "")

    def connections(self):
        return (
            Connection(("source",), self.ends[0], "source"),
            Connection(("destination",), self.ends[1], "receiver"),
        )


def test_a_kind_of_ones_own_is_drawn_as_a_box_with_its_pipes(process):
    elements = (
        *process.elements,
        Clarifier("settler"),
        Siphon("siphon_1", ends=("tank_1", "settler")),
        Siphon("siphon_2", ends=("settler", "basin")),
    )
    own = replace(process, elements=elements)
    drawing = process_drawing(own, find_equilibrium(process))
    for words in ("clarifier settler", "siphon siphon_1", "siphon siphon_2"):
        assert f"<title>{words}</title>" in drawing
    routes = route(flow_graph(own), {})
    check_geometry(routes)
    assert {
        frozenset(pair)
        for pair in (("tank_1", "siphon_1"), ("siphon_1", "settler"), ("settler", "siphon_2"))
    } <= joints(routes)


def test_without_a_controller_there_are_transmitters_alone(process):
    drawing = process_drawing(process, find_equilibrium(process))
    assert drawing.count(">LIC<") == 0
    assert drawing.count(">LT<") == 4


def test_words_of_a_file_cannot_break_the_drawing(process):
    hostile = replace(process, title='</title><script>alert("x")</script>')
    ElementTree.fromstring(process_drawing(hostile, find_equilibrium(process)))
    assert "<script" not in process_drawing(hostile, find_equilibrium(process))


def test_long_names_beside_pumps_are_shortened_and_told_in_full_to_who_asks(tmp_path):
    name = "condensate_feed_pump_of_line_2301_west"
    text = catalogue_file("quadruple-tank").read_text("utf-8").replace("pump_1", name)
    process = plant_of(tmp_path, text).process
    drawing = process_drawing(process, find_equilibrium(process))
    assert f"<title>pump {name}, 3.00 V, 30 %</title>" in drawing
    written = re.findall(r'class="name">([^<]*)<', drawing)
    assert name not in written
    assert max(len(words) for words in written) <= 24


def test_a_flow_from_outside_is_hollow_while_nothing_flows():
    process = load_process("eight-tanks")  # the feed runs, the load inflow_1 rests
    drawing = process_drawing(process, find_equilibrium(process))
    fills = {
        name: re.search(
            rf'<g tr[^>]*><title>[^<]*{name}\b[^<]*</title><[^>]*fill="([^"]*)"', drawing
        )[1]
        for name in ("feed", "inflow_1")
    }
    assert fills == {"feed": PIPE, "inflow_1": PAPER}
