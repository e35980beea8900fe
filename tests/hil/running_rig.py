"""A plant at several times real time, and soft PLCs on its tags."""

from plc_bench import READY
from running_plant import RunningPlant

from clepsydra.hil.plant_rows import PlantRows
from clepsydra.hil.soft_plc import SoftPlc, SoftPlcSettings
from clepsydra.hil.wiring import wiring_of

SPEED = 10.0


class RunningRig(RunningPlant):
    """A plant, and soft PLCs on its tags."""

    def __init__(self, folder) -> None:
        super().__init__(folder, SPEED)
        self.tags = tuple(self.table.tags.values())
        self.wiring = wiring_of(READY, self.tags)

    def plc(self, image, bus) -> SoftPlc:
        return SoftPlc(SoftPlcSettings(image, self.wiring, bus, 1.0, SPEED))

    def rows(self) -> PlantRows:
        """All that it went through."""
        found = PlantRows(self.settings.layout)
        found.take(self.image)
        return found

    def operate(self, tag: str, value: float) -> None:
        self.table.write(self.table.tags[tag], value)
