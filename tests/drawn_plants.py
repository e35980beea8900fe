"""Plants that are drawn in tests: as text of process files, and beside the tests of drawings."""

from pathlib import Path

from clepsydra.process.reader import load_process


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
FILES = {
    name: Path(__file__).parent / "report" / f"{name}.toml" for name in ("many-shapes", "valves")
}


def loaded(name, folder):
    """The process of a name: of the catalogue, a file of tests/report, or text above."""
    if name in FILES:
        return load_process(FILES[name])
    text = {**PLANTS, **CHAINS}.get(name)
    if text is None:
        return load_process(name)
    (folder / "plant.toml").write_text(text, encoding="utf-8")
    return load_process(folder / "plant.toml")
