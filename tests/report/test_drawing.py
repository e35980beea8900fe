import re
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from pathlib import Path
from random import Random
from typing import ClassVar
from xml.etree import ElementTree

import pytest

from clepsydra import Connection, Element
from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.report.drawing.bodies import TANK_HALF, TANK_ROWS
from clepsydra.report.drawing.flow_graph import FlowGraph, Instrument, Junction, Link, flow_graph
from clepsydra.report.drawing.outline import TANK_HEIGHT
from clepsydra.report.drawing.plant import process_drawing
from clepsydra.report.drawing.routing import route

SVG = "{http://www.w3.org/2000/svg}"


def plant(tanks, orifices, pumps, splitters=(), inflows=(), reservoirs=("basin",)):
    """A process file with tanks of one size; each element is given by what it connects."""
    lines = ['name = "plant"', 'title = "A plant"', 'source = "made up"', 'sampling_period = "1 s"']
    lines.append(f'controlled = ["sensor_{tanks[-1]}"]')
    lines += [f"[reservoirs.{name}]" for name in reservoirs]
    for name in tanks:
        lines += [f"[tanks.{name}]", 'area = "100 cm^2"', 'height = "50 cm"']
        lines += [f"[sensors.sensor_{name}]", f'tank = "{name}"', 'range = ["0 cm", "50 cm"]']
    for name, source, destination in orifices:
        lines += [f"[orifices.{name}]", f'source = "{source}"', f'destination = "{destination}"']
        lines.append('area = "0.4 cm^2"')
    for name, source, destination in pumps:
        lines += [f"[pumps.{name}]", f'source = "{source}"', f'destination = "{destination}"']
        lines += ['gain = "15 cm^3/(s V)"', 'range = ["0 V", "10 V"]', 'nominal = "3 V"']
    for name, shares in splitters:
        inner = ", ".join(f"{receiver} = {share}" for receiver, share in shares.items())
        lines += [f"[splitters.{name}]", f"fractions = {{ {inner} }}"]
    for name, destination in inflows:
        lines += [f"[flows.{name}]", f'destination = "{destination}"']
        lines += ['range = ["0 cm^3/s", "10 cm^3/s"]', 'nominal = "2 cm^3/s"']
        lines.append('step = "3 cm^3/s"')
    return "\n".join(lines) + "\n"


PLANTS = {
    "single": plant(
        ["vessel"], [("hole", "vessel", "basin")], [("pump", "basin", "vessel")],
        inflows=[("rain", "vessel")],
    ),
    "two in series": plant(
        ["upper", "lower"], [("a", "upper", "lower"), ("b", "lower", "basin")],
        [("pump", "basin", "upper")], inflows=[("rain", "lower")],
    ),
    "three in series, two reservoirs": plant(
        ["t1", "t2", "t3"], [("a", "t1", "t2"), ("b", "t2", "t3"), ("c", "t3", "sump")],
        [("feed", "supply", "t1"), ("second", "supply", "t3")], reservoirs=("supply", "sump"),
    ),
    "splitter behind a splitter": plant(
        ["a", "b", "c"], [("oa", "a", "basin"), ("ob", "b", "basin"), ("oc", "c", "basin")],
        [("pump", "basin", "s1")], [("s1", {"a": 0.5, "s2": 0.5}), ("s2", {"b": 0.6, "c": 0.4})],
        inflows=[("leak", "s2")],
    ),
    "three into one, with a relief": plant(
        ["left", "right", "a_name_much_too_long_for_its_tank", "last"],
        [("o1", "left", "last"), ("o2", "right", "last"), ("relief", "left", "basin"),
         ("o3", "a_name_much_too_long_for_its_tank", "last"), ("o4", "last", "basin")],
        [("p1", "basin", "s"), ("p2", "basin", "a_name_much_too_long_for_its_tank")],
        [("s", {"left": 0.4, "right": 0.3, "basin": 0.3})],
    ),
    "splitter under a tank": plant(
        ["top", "m1", "m2"],
        [("o1", "top", "s"), ("o2", "m1", "basin"), ("o3", "m2", "basin"), ("o4", "top", "m2")],
        [("p", "basin", "top")], [("s", {"m1": 0.6, "m2": 0.4})],
    ),
}  # fmt: skip


def chain(length, kind):
    """A process file with tanks in a row: falling into each other, joined, or pumped."""
    lines = ['name = "chain"', 'sampling_period = "1 s"', f'controlled = ["level_{length}"]']
    lines.append("[reservoirs.basin]")
    pump = ['gain = "15 cm^3/(s V)"', 'range = ["0 V", "10 V"]', 'nominal = "3 V"']
    for number in range(1, length + 1):
        below = f"tank_{number + 1}" if number < length else "basin"
        ends = [f'source = "tank_{number}"', f'destination = "{below}"']
        lines += [f"[tanks.tank_{number}]", 'area = "100 cm^2"', 'height = "50 cm"']
        lines += [f"[sensors.level_{number}]", f'tank = "tank_{number}"']
        lines.append('range = ["0 cm", "50 cm"]')
        if kind == "pumped" and number < length:
            lines += [f"[pumps.pump_{number}]", *ends, *pump]
            continue
        joined = kind == "joined" and number < length
        area = ['area = "4 cm^2"', "submerged = true"] if joined else ['area = "0.4 cm^2"']
        lines += [f"[orifices.out_{number}]", *ends, *area]
    lines += ["[pumps.feed]", 'source = "basin"', 'destination = "tank_1"', *pump]
    return "\n".join(lines) + "\n"


CHAINS = {
    f"{length} {kind}": chain(length, kind)
    for length in (8, 10, 20)
    for kind in ("falling", "joined", "pumped")
}
FILES = {name: Path(__file__).with_name(f"{name}.toml") for name in ("many-shapes", "valves")}


def loaded(name, folder):
    """The process of a name: of the catalogue, a file beside this one, or text above."""
    if name in FILES:
        return load_process(FILES[name])
    text = {**PLANTS, **CHAINS}.get(name)
    if text is None:
        return load_process(name)
    (folder / "plant.toml").write_text(text, encoding="utf-8")
    return load_process(folder / "plant.toml")


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
    routes = route(flow_graph(process), labels, frozenset(process.controlled))
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
    """See that no pipe runs through or along anything, and that no two parts overlap."""
    bodies = routes.placement.bodies.values()
    for pipe in routes.pipes:
        for (x1, y1), (x2, y2) in segments(pipe.points):
            assert (x1 == x2) != (y1 == y2), pipe
        sideways, upright = covered(pipe)
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
    for pipe in routes.pipes:
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
    routes = route(graph, {}, frozenset(i.name for i in graph.instruments[::2]))
    check_geometry(routes)
    named = {
        frozenset((link.name, end))
        for link in graph.links
        for end in (*link.sources, *link.targets)
    }
    named |= {frozenset((j.name, end)) for j in graph.junctions for _, end in j.branches}
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
        junctions.append(Junction(f"junction_{n}", symbol, tuple((1 / count, e) for e in ends)))
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
        fed |= {end for _, end in junction.branches}
        if junction.name not in fed:
            links.append(Link(f"feed_{number}", "pump", (basins[0],), (junction.name,)))
    meters = [random.choice([*tanks, *(link.name for link in links)]) for _ in range(4)]
    return FlowGraph(
        tuple(tanks), tuple(basins), tuple(links), tuple(junctions),
        tuple(Instrument(f"meter_{n}", "L", seat, 101 + n) for n, seat in enumerate(meters)),
    )  # fmt: skip


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
    assert process_drawing(process, find_equilibrium(process)).count("a6.0 6.0 0 0") == 1


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
    titles = re.findall("<title>([A-Z]+)-[0-9]+: ([a-z_ ]*)", process_drawing(process, None))
    found = {(letters, words.split()[1 if "C" in letters else 0]) for letters, words in titles}
    assert found == {
        ("FT", "flow_main"), ("FIC", "flow_main"), ("FT", "flow_cross"), ("FT", "flow_out"),
        ("LT", "level_c"), ("LIC", "level_c"), ("AT", "salt_c"),
    }  # fmt: skip


def test_a_pump_points_where_it_delivers():
    # From the well down to the works, so not upward as from a reservoir.
    process = load_process("wet-well")
    drawing = process_drawing(process, None)
    bodies = route(flow_graph(process), {}).placement.bodies
    assert bodies["standby"].y > bodies["well"].y
    path = re.search(r"<title>pump standby</title><circle[^>]*/><path d=\"M([^Z]*)Z", drawing)
    corners = [tuple(float(n) for n in pair.split()) for pair in path.group(1).split("L")]
    (_, left), (_, tip), (_, right) = corners
    assert left == right < tip


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


def test_only_controlled_levels_have_a_controller(process):
    drawing = process_drawing(process, find_equilibrium(process))
    assert drawing.count(">LIC<") == 2
    assert drawing.count(">LT<") == 4


def test_words_of_a_file_cannot_break_the_drawing(process):
    hostile = replace(process, title='</title><script>alert("x")</script>')
    ElementTree.fromstring(process_drawing(hostile, find_equilibrium(process)))
    assert "<script" not in process_drawing(hostile, find_equilibrium(process))


def test_long_names_beside_pumps_are_shortened_and_told_in_full_to_who_asks(tmp_path):
    name = "condensate_feed_pump_of_line_2301_west"
    text = catalogue_file("quadruple-tank").read_text("utf-8").replace("pump_1", name)
    path = tmp_path / "long.toml"
    path.write_text(text, encoding="utf-8")
    process = load_process(path)
    drawing = process_drawing(process, find_equilibrium(process))
    assert f"<title>pump {name}, 3.00 V, 30 %</title>" in drawing
    written = re.findall(r'class="name">([^<]*)<', drawing)
    assert name not in written
    assert max(len(words) for words in written) <= 24
