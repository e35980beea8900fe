"""A door of a running plant, in a process of its own, and where it is found."""

from collections.abc import Iterator
from contextlib import contextmanager

from running_plant import RunningPlant
from waiting import wait_until

from clepsydra.rig.child import Child, reports_of
from clepsydra.rig.doors.door import Door
from clepsydra.rig.doors.door_process import serve_door
from clepsydra.rig.doors.modbus.door import ModbusDoor
from clepsydra.rig.doors.modbus.encoding import Encoding
from clepsydra.rig.doors.modbus.register_map import RegisterMap, default_map
from clepsydra.rig.report import Kind


@contextmanager
def served(plant: RunningPlant, door: Door) -> Iterator[str]:
    """Serve the tags of a plant, and give the address at which that is done."""
    door.check()
    tags = tuple(plant.table.tags.values())
    child = Child(door.title, serve_door, (door, tags, plant.path, plant.settings.layout))
    child.start()
    found: list[str] = []

    def is_ready() -> bool:
        reports = reports_of([child], 0.0)
        found.extend(report.words for _, report in reports if report.kind is Kind.READY)
        assert found or child.is_alive
        return bool(found)

    try:
        wait_until(is_ready)
        yield found[0]
    finally:
        child.end()


@contextmanager
def by_modbus(plant: RunningPlant, encoding: str) -> Iterator[tuple[RegisterMap, str, int]]:
    """Serve registers in an encoding of measured values; gives their map, host and port."""
    registers = default_map(plant.table.tags.values(), Encoding(encoding))
    with served(plant, ModbusDoor(registers, port=0)) as address:
        host, port = address.rsplit(":", 1)
        yield registers, host, int(port)


@contextmanager
def by_opc_ua(plant: RunningPlant) -> Iterator[object]:
    """Serve nodes; gives how a controller comes in."""
    from clepsydra.rig.doors.opc_ua.client import access_to_rig
    from clepsydra.rig.doors.opc_ua.door import OpcUaDoor
    from clepsydra.rig.doors.opc_ua.identity import Identity

    folder = plant.path.parent
    certificates = folder / "certificates"
    door = OpcUaDoor(certificates, tuple(plant.table.tags.values()), port=0)
    with served(plant, door) as address:
        yield access_to_rig(address, certificates, Identity(folder / "plc", "controller"))
