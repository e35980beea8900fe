"""Random processes of one to four tanks, as the text of a process file.

Every kind of vessel, outlet, actuator and sensor that a process file may have, joined at random
from a feed down to a basin; the levels at the start are anywhere, at rest or not.
"""

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from clepsydra.linear.operating_point import OperatingPoint
from clepsydra.process.process import Process
from clepsydra.process.reader import load_process

VESSELS = (
    'area = "300 cm^2"\nheight = "50 cm"',
    'diameter = "20 cm"\nheight = "40 cm"',
    'shape = "table"\ntable = [["0 cm", "20 cm^2"], ["10 cm", "300 cm^2"], ["45 cm", "135 cm^2"]]',
    'shape = "cone"\nrim_diameter = "40 cm"\nheight = "60 cm"',
    'shape = "cone"\nfloor_diameter = "40 cm"\nrim_diameter = "20 cm"\nheight = "60 cm"',
    'shape = "sphere"\ndiameter = "50 cm"\nheight = "40 cm"',
    'shape = "horizontal cylinder"\ndiameter = "40 cm"\nlength = "1 m"\nwhen_full = "run ends"',
)
HEIGHTS = (0.50, 0.40, 0.45, 0.60, 0.60, 0.40, 0.40)
SIGNALS = ('["0 V", "10 V"]', '["4 mA", "20 mA"]', '["0 %", "100 %"]', '["0 Hz", "50 Hz"]')
NOMINAL = ('"4 V"', '"12 mA"', '"60 %"', '"20 Hz"')
PER_UNIT = ("V", "mA", "%", "Hz")
#: Of what is shown: a sensor of a level by its range alone, by a gain, or by a span.
READINGS = (
    'range = ["0 cm", "60 cm"]', 'gain = "0.1 V/cm"\nrange = ["0 V", "6 V"]',
    'span = ["0 cm", "50 cm"]\nrange = ["4 mA", "20 mA"]',
)  # fmt: skip


class ProcessFile:
    """The text of a process file, and where the process starts."""

    def __init__(self, text: str, start: int) -> None:
        self.text, self.start = text, start

    def __repr__(self) -> str:
        return f"\n# start {self.start}\n{self.text}"

    def process(self) -> Process:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "random.toml")
            path.write_text(self.text, encoding="utf-8")
            return load_process(path)

    def point(self) -> OperatingPoint:
        """Somewhere: any level, any concentration.

        The actuators rest. A rate that is at its limit has no derivative, so that the steps of
        the integration would be chosen without the actuator.
        """
        process, random = self.process(), np.random.default_rng(self.start)
        resting = {}
        for signal in process.inputs:
            share = (signal.initial - signal.low) / signal.span
            resting |= {f"{signal.name}.actual": signal.initial, f"{signal.name}.position": share}
        x = np.array([
            resting.get(signal.name, _somewhere(signal, random)) for signal in process.state
        ])  # fmt: skip
        u = np.array([signal.initial for signal in process.inputs])
        d = np.array([signal.initial for signal in process.disturbances])
        y = np.array(process.measure(x, process.parameter_values)).ravel()
        return OperatingPoint(process, x, u, d, y, residual=np.inf)


def _somewhere(signal, random: np.random.Generator) -> float:
    """A value of a state in its range, at times near its low end."""
    low = signal.low if np.isfinite(signal.low) else 0.0
    high = signal.high if np.isfinite(signal.high) else low + 1.0
    place = random.choice([random.uniform(0.1, 0.8), 0.05], p=[0.8, 0.2])
    return float(low + place * (high - low))


class _Plant:
    """The tables of a process file while they are drawn."""

    def __init__(self, draw, most: int) -> None:
        self.draw = draw
        self.tables: list[str] = []
        self.manipulated: list[str] = []
        self._count: dict[str, int] = {}
        count = draw(st.sampled_from([c for c in (1, 2, 1, 3, 2, 4) if c <= most]))
        self.tanks = [f"tank_{k}" for k in range(1, count + 1)]
        self.heights: dict[str, float] = {}
        self.salt = draw(st.booleans())

    def table(self, kind: str, name: str, *keys: str) -> str:
        self.tables.append("\n".join([f"[{kind}.{name}]", *filter(None, keys)]))
        return name

    def new(self, stem: str) -> str:
        self._count[stem] = self._count.get(stem, 0) + 1
        return f"{stem}_{self._count[stem]}"

    def maybe(self, *keys: str) -> str:
        """One of the keys, or none."""
        return self.draw(st.sampled_from(["", *keys]))

    def whole(self) -> ProcessFile:
        draw = self.draw
        if self.salt:
            self.tables.append('[components.salt]\nrange = ["0 g/l", "50 g/l"]')
            self.table("reservoirs", "basin", 'concentration = { salt = "10 g/l" }')
        else:
            self.table("reservoirs", "basin")
        for tank in self.tanks:
            vessel = draw(st.integers(0, len(VESSELS) - 1))
            self.heights[tank] = HEIGHTS[vessel]
            # A full tank spills over its weir: beside one, the file may not say when_full.
            weir = "" if "when_full" in VESSELS[vessel] else self.maybe('weir = "15 cm"')
            evaporation = self.maybe('evaporation = "2 mm/h"')
            self.table("tanks", tank, VESSELS[vessel], weir, evaporation)
        self._feed()
        for place, tank in enumerate(self.tanks):
            for _ in range(draw(st.sampled_from([1, 1, 2]))):
                self._outlet(tank, self.tanks[place + 1 :])
        sensors = self._sensors()
        controlled = sensors[: draw(st.integers(1, min(len(sensors), len(self.manipulated))))]
        period = draw(st.sampled_from([1.0, 0.1, 2.0]))
        general = [
            'name = "random"', 'title = "A random plant, Füllstand < 3 & \\"more\\""',
            f'sampling_period = "{period} s"', f"controlled = {_written(controlled)}",
            f"manipulated = {_written(self.manipulated)}",
        ]  # fmt: skip
        text = "\n\n".join(["\n".join(general), *self.tables]) + "\n"
        delay = period * draw(st.sampled_from([1.0, 2.0, 0.5, 2.5, 9.0]))
        return ProcessFile(text.replace("DELAY", f"{delay:.12g} s"), draw(st.integers(0, 5)))

    def _receiver(self, below: list[str], *, basin: bool = True) -> str:
        """A tank below, the basin, or a splitter or a delay on the way."""
        target = self.draw(st.sampled_from([*below, "basin"] if basin else below))
        way = self.draw(st.integers(0, 4))
        if way == 3:
            return self.table("delays", self.new("channel"), f'destination = "{target}"',
                              'time = "DELAY"')  # fmt: skip
        if way == 4 and target != "basin":
            share = self.draw(st.sampled_from([0.7, 0.3, 1.0]))
            fractions = f"{{ {target} = {share}, basin = {round(1 - share, 3)} }}"
            return self.table("splitters", self.new("splitter"), f"fractions = {fractions}")
        return target

    def _feed(self) -> None:
        """A pump, and perhaps a flow from outside, into tanks."""
        self._pump("basin", self._receiver(self.tanks, basin=False))
        if self.draw(st.booleans()):
            name = self.new("inflow")
            tank = self.draw(st.sampled_from(self.tanks))
            self.table("flows", name, f'destination = "{tank}"', 'range = ["0 l/s", "2 l/s"]',
                       'nominal = "0.3 l/s"', self.maybe('step = "0.1 l/s"'))  # fmt: skip
            if self.salt and self.draw(st.booleans()):
                self.tables.append(
                    f'[flows.{name}.concentration.salt]\nrange = ["0 g/l", "50 g/l"]\n'
                    'nominal = "20 g/l"'
                )
                if self.draw(st.booleans()):
                    self.manipulated.append(f"{name}.salt")

    def _pump(self, source: str, destination: str) -> None:
        name, signal = self.new("pump"), self.draw(st.integers(0, 3))
        size = {"V": 60, "mA": 30, "%": 6, "Hz": 12}[PER_UNIT[signal]]
        curved = self.draw(st.booleans())
        if curved:
            keys = [
                'curve = [["0 l/s", "3 m"], ["0.4 l/s", "2.5 m"], ["0.8 l/s", "1 m"]]',
                'static_head = "60 cm"', self.maybe('pipe_loss = "2e5 s^2/m^5"'),
            ]  # fmt: skip
        else:
            unit = PER_UNIT[signal]
            keys = [f'gain = "{size} cm^3/(s {unit})"', self.maybe(f'dead_band = "4.5 {unit}"')]
        keys += [
            f"range = {SIGNALS[signal]}", f"nominal = {NOMINAL[signal]}",
            self.maybe('lag = "0.5 s"'), self.maybe(f'rate = "3 {PER_UNIT[signal]}/s"'),
            self._switches(source),
        ]  # fmt: skip
        self.table("pumps", name, f'source = "{source}"', f'destination = "{destination}"', *keys)
        self.manipulated.append(name)

    def _switches(self, source: str) -> str:
        """Trips by the level of a tank, or starts and stops."""
        tank = source if source in self.tanks else self.draw(st.sampled_from(self.tanks))
        high = f"{70 * self.heights[tank]:.3g} cm"
        low = f"{20 * self.heights[tank]:.3g} cm"
        trip = f'trip_above = {{ {tank} = "{high}" }}\nhysteresis = "2 cm"'
        levels = f'start_above = {{ {tank} = "{high}" }}\nstop_below = {{ {tank} = "{low}" }}'
        stopped = f"{levels}\nrunning = false"
        both = f'{trip}\ntrip_below = {{ {tank} = "{low}" }}'
        return self.draw(st.sampled_from(["", "", trip, both, levels, stopped]))

    def _outlet(self, tank: str, below: list[str]) -> None:
        kind = self.draw(st.sampled_from(["orifice", "tube", "valve", "pump", "flow"]))
        submerged = bool(below) and kind != "pump" and self.draw(st.integers(0, 2)) == 2
        target = self.draw(st.sampled_from(below)) if submerged else self._receiver(below)
        ends = [f'source = "{tank}"', f'destination = "{target}"']
        flag = "submerged = true" if submerged else ""
        if kind == "pump":
            self._pump(tank, target)
        elif kind == "flow":
            ends = ends[:1] if target == "basin" else ends
            keys = 'range = ["0 l/s", "1 l/s"]', 'nominal = "0.1 l/s"'
            self.table("flows", self.new("draw"), *ends, *keys)
        elif kind == "orifice":
            self.table("orifices", self.new("orifice"), *ends, 'area = "0.9 cm^2"', flag,
                       self.maybe("discharge = 0.61"), self.maybe('elevation = "5 cm"'),
                       self.maybe('laminar = "5 mm"'))  # fmt: skip
        elif kind == "tube":
            self.table("linear_outlets", self.new("tube"), *ends, flag,
                       'coefficient = "3 cm^2/s"')  # fmt: skip
        else:
            self._valve(ends, flag)

    def _valve(self, ends: list[str], flag: str) -> None:
        signal = self.draw(st.integers(0, 3))
        friction = self.maybe('backlash = "6 %"', 'stiction = "5 %"\nslip_jump = "3 %"')
        stroke = self.maybe('stroke_time = "6 s"', 'lag = "2 s"')
        if friction:
            stroke = 'stroke_time = "6 s"'
        keys = [
            'kv = "3 m^3/h"', f"range = {SIGNALS[signal]}", f"nominal = {NOMINAL[signal]}",
            self.maybe('characteristic = "equal percentage"', 'characteristic = "quick opening"'),
            self.maybe('line_kv = "4 m^3/h"'), self.maybe('pressure = "0.02 bar"'),
        ]  # fmt: skip
        name = self.table("valves", self.new("valve"), *ends, flag, *keys, stroke, friction)
        self.manipulated.append(name)

    def _sensors(self) -> list[str]:
        found = []
        for tank in self.tanks:
            name = self.new("level")
            reading = self.draw(st.sampled_from(READINGS))
            keys = (self.maybe(key) for key in ('lag = "2 s"', 'noise = "0.2 %"',
                                                'resolution = "0.5 %"'))  # fmt: skip
            self.table("sensors", name, f'tank = "{tank}"', reading, *keys)
            found.append(name)
        if self.salt:
            self.table("sensors", "salinity", f'tank = "{self.tanks[-1]}"', 'component = "salt"',
                       'range = ["0 g/l", "50 g/l"]', self.maybe('lag = "5 s"'))  # fmt: skip
        if self.draw(st.booleans()):
            self.table("sensors", "volume", f'tank = "{self.tanks[0]}"', 'quantity = "volume"',
                       'range = ["0 l", "200 l"]', 'lag = "1 s"')  # fmt: skip
        if self.draw(st.booleans()):
            self.table("sensors", "meter", 'flow = "pump_1"', 'range = ["0 l/s", "1 l/s"]',
                       'lag = "0.5 s"')  # fmt: skip
        return found


def _written(names: list[str]) -> str:
    return "[" + ", ".join(f'"{name}"' for name in names) + "]"


@st.composite
def processes(draw, most: int = 4) -> ProcessFile:
    """A process file of at most so many tanks."""
    return _Plant(draw, most).whole()
