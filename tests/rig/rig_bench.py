"""Plants of rigs, moved without a clock."""

from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import clepsydra as cl
from clepsydra.laboratory.rig import Rig
from clepsydra.rig.assembly import plant_settings
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.plant import RigPlant
from clepsydra.rig.tag_table import TagTable
from clepsydra.rig.tags import tags_of


class Bench:
    """A quadruple tank, or another process, whose samples a test goes through itself."""

    def __init__(self, folder: Path, name="quadruple-tank", **settings) -> None:
        self.plant_model = cl.load(name)
        bench = Rig(self.plant_model.linear, [cl.design.simc(self.plant_model)])
        self.process = bench.point.process
        self.settings = plant_settings(bench, speed=1.0, fail_safe={}, **settings)
        self.path = folder / "image"
        self.image = ProcessImage(self.path, self.settings.layout, new=True)
        self.table = TagTable(tags_of(bench.point), self.image)
        self.plant = RigPlant(self.settings, self.image)
        self.plant.tell(0.0)

    def tag(self, name):
        return self.table.tags[name]

    def read(self, name):
        return self.table.read(self.tag(name))

    def write(self, name, value):
        self.table.write(self.tag(name), value)

    def step(self, samples=1, heard=True):
        for _ in range(samples):
            self.plant.step(heard=heard, time=float(self.plant.sample + 1))


@contextmanager
def bench(name="quadruple-tank", **settings):
    with TemporaryDirectory() as folder:
        yield Bench(Path(folder), name, **settings)
