"""The plant of a rig in a process of its own, in real time, and the image through which it goes."""

from pathlib import Path

from rig_bench import Bench

from clepsydra.rig.child import Child
from clepsydra.rig.image import ProcessImage
from clepsydra.rig.plant_process import run_plant


class RunningPlant:
    """A quadruple tank at several times real time; it is started, and ended, by hand."""

    def __init__(self, folder: Path, speed: float) -> None:
        bench = Bench(folder)
        self.settings, self.path, self.table = bench.settings, bench.path, bench.table
        # That of the bench has gone through a beginning already.
        self.image = ProcessImage(self.path, self.settings.layout, new=True)
        self.table.image = self.image
        self.process = Child("plant", run_plant, (self.settings, self.path, speed))

    @property
    def sample(self) -> int:
        return self.image.published().sample

    @property
    def heartbeat(self) -> float:
        """The count of the controller's scans."""
        return self.image.read("controller.heartbeat")
