import re
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree

import pytest

from clepsydra.linear.equilibrium import find_equilibrium
from clepsydra.process.catalogue_names import catalogue_file, catalogue_names
from clepsydra.process.reader import load_process
from clepsydra.report.drawing import process_drawing
from clepsydra.report.flow_graph import flow_graph
from clepsydra.report.placement import TANK_HEIGHT, TANK_WIDTH, place
from clepsydra.report.routing import route

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
        lines += [f"[inflows.{name}]", f'destination = "{destination}"']
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


@pytest.fixture(scope="module", params=[*catalogue_names(), *PLANTS])
def drawn(request, tmp_path_factory):
    """A process with its placement, its routes and its drawing."""
    source = request.param
    if source in PLANTS:
        source = tmp_path_factory.mktemp("plant") / "plant.toml"
        Path(source).write_text(PLANTS[request.param], encoding="utf-8")
    process = load_process(source)
    graph = flow_graph(process)
    placement = place(graph, {element.name: (element.name,) for element in process.elements})
    drawing = process_drawing(process, find_equilibrium(process))
    return process, placement, route(placement), drawing


def segments(pipe):
    return list(zip(pipe.points, pipe.points[1:], strict=False))


def test_pipes_are_orthogonal(drawn):
    _, _, routes, _ = drawn
    for pipe in routes.pipes:
        for (x1, y1), (x2, y2) in segments(pipe):
            assert x1 == x2 or y1 == y2


def test_no_pipe_runs_through_a_tank(drawn):
    _, placement, routes, _ = drawn
    for tank, top in routes.tops.items():
        left = placement.centre[tank] - TANK_WIDTH / 2
        for pipe in routes.pipes:
            for (x1, y1), (x2, y2) in segments(pipe):
                across = min(x1, x2) < left + TANK_WIDTH and max(x1, x2) > left
                # A pipe may end just inside the rim.
                within = min(y1, y2) < top + TANK_HEIGHT and max(y1, y2) > top + 4
                assert not (across and within), (pipe.title, tank)


def test_tanks_do_not_overlap_and_stand_above_those_that_they_drain_into(drawn):
    _, placement, routes, _ = drawn
    for one, other in combinations(routes.tops, 2):
        apart = abs(placement.centre[one] - placement.centre[other]) >= TANK_WIDTH
        assert apart or abs(routes.tops[one] - routes.tops[other]) >= TANK_HEIGHT
    for outlet in placement.graph.outlets:
        if outlet.target in routes.tops:
            assert routes.tops[outlet.source] + TANK_HEIGHT < routes.tops[outlet.target]


def test_uprights_of_different_pipes_do_not_lie_on_each_other(drawn):
    _, _, routes, _ = drawn
    for one, other in combinations(routes.pipes, 2):
        if one.line == other.line or one.source == other.source:
            continue
        for (ax, ay), (bx, by) in segments(one):
            for (cx, cy), (dx, dy) in segments(other):
                if ax == bx == cx == dx:
                    assert max(min(ay, by), min(cy, dy)) >= min(max(ay, by), max(cy, dy))
                if ay == by == cy == dy:
                    assert max(min(ax, bx), min(cx, dx)) >= min(max(ax, bx), max(cx, dx))


def test_every_flow_of_the_process_is_drawn_and_ends_where_it_should(drawn):
    process, placement, routes, _ = drawn
    # A second source of a splitter ends at the upright of the first one.
    joining = [riser for riser in placement.risers if riser.split is None and not riser.targets]
    for tank, top in routes.tops.items():
        entering = {
            pipe
            for pipe in routes.pipes
            if pipe.points[-1][1] == top + 3
            and abs(pipe.points[-1][0] - placement.centre[tank]) < TANK_WIDTH / 2
        }
        sources = {pipe.source for pipe in entering}
        for riser in joining:
            if riser.parent.name in {pipe.line for pipe in entering}:
                (own,) = [pipe for pipe in routes.pipes if pipe.source == riser.name]
                assert own.points[0][0] == riser.x and own.points[-1][0] == riser.parent.x
                sources.add(riser.name)
        assert sources == sources_of(process, tank)


def sources_of(process, receiver):
    """Pumps, inflows and tanks whose liquid reaches an element, splitters passed over."""
    found = set()
    for element in process.elements:
        targets = getattr(element, "destinations", None) or [getattr(element, "destination", "")]
        if receiver not in targets:
            continue
        if hasattr(element, "destinations"):
            found |= sources_of(process, element.name)
        else:
            found.add(element.source if element.kind == "orifice" else element.name)
    return found


def test_the_drawing_is_well_formed_and_names_every_element(drawn):
    process, _, _, drawing = drawn
    root = ElementTree.fromstring(drawing)
    titles = " | ".join(title.text for title in root.iter(f"{SVG}title"))
    for element in process.elements:
        assert element.name in titles, element
    _, _, width, height = (float(number) for number in root.get("viewBox").split())
    for text in root.iter(f"{SVG}text"):
        reach = (
            7.5 * len(text.text) * {"start": 0, "middle": 0.5, "end": 1}[text.get("text-anchor")]
        )
        rest = 7.5 * len(text.text) - reach
        assert float(text.get("x")) - reach >= 0 and float(text.get("x")) + rest <= width
        assert 0 < float(text.get("y")) < height


@pytest.mark.parametrize("name", ["quadruple-tank", "quadruple-tank-nonminimum-phase"])
def test_the_quadruple_tank_looks_like_the_picture_in_the_paper(name):
    process = load_process(name)
    placement = place(flow_graph(process), {e.name: (e.name,) for e in process.elements})
    routes = route(placement)
    centre, tops = placement.centre, routes.tops
    assert centre["tank_1"] == centre["tank_3"] < centre["tank_2"] == centre["tank_4"]
    assert tops["tank_3"] == tops["tank_4"] < tops["tank_1"] == tops["tank_2"]
    pumps = {riser.name: riser.x for riser in placement.risers}
    assert pumps["pump_1"] < centre["tank_1"] - TANK_WIDTH / 2
    assert pumps["pump_2"] > centre["tank_2"] + TANK_WIDTH / 2
    # The diagonal pipes have to cross once, and nothing else does.
    assert process_drawing(process, find_equilibrium(process)).count("a6.0 6.0 0 0") == 1


def test_water_stands_at_the_scale_of_its_tank(process):
    point = find_equilibrium(process)
    root = ElementTree.fromstring(process_drawing(process, point))
    for place_, signal in enumerate(process.state):
        (group,) = [
            entry
            for entry in root.iter(f"{SVG}g")
            if entry[0].tag == f"{SVG}title" and entry[0].text.startswith(f"tank_{place_ + 1}: ")
        ]
        water = group.findall(f"{SVG}rect")[1]
        share = float(water.get("height")) / TANK_HEIGHT
        assert share == pytest.approx(point.state[place_] / signal.high, abs=0.1 / TANK_HEIGHT)


def test_only_controlled_levels_have_a_controller(process):
    drawing = process_drawing(process, find_equilibrium(process))
    assert drawing.count(">LIC<") == 2
    assert drawing.count(">LT<") == 4


def test_words_of_a_file_cannot_break_the_drawing(process):
    from dataclasses import replace

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
