"""The doors of a rig: what is asked for, and what each is made of."""

from __future__ import annotations

import ipaddress
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import Finding, InputError
from clepsydra.interface.rig_client import client_door
from clepsydra.rig.doors.packages import require_packages

if TYPE_CHECKING:
    from clepsydra.laboratory.rig import Rig
    from clepsydra.rig.doors.door import Door
    from clepsydra.rig.doors.modbus.register_map import RegisterMap
    from clepsydra.rig.settings import RigSettings
    from clepsydra.rig.tag import Tag

#: Door to the packages that it serves with; Modbus needs none.
PACKAGES: dict[str, tuple[str, ...]] = {
    "modbus": (), "opc-ua": ("asyncua", "cryptography"), "page": ("websockets",),
}  # fmt: skip
#: Of the machine itself: nobody else reaches a rig unless it is asked for.
LOOPBACK = "127.0.0.1"


def doors_without_package() -> list[str]:
    """Return the doors whose package is not installed."""
    return [name for name, needed in PACKAGES.items() if None in map(find_spec, needed)]


@dataclass(frozen=True)
class Doors:
    """Which doors a rig has, and where.

    Parameters
    ----------
    open : collection of str, optional
        "modbus", …; all that are installed if left out.
    ports : mapping
        Door to its port, where that is another than usual.
    host : str
        The address of this machine at which they listen.
    registers : str or Path, optional
        Of a CSV file with the register map; one is made of the tags if left out.
    encoding : str
        Of values in registers, where the map is made: "float32", "float32-low-word-first", or the
        counts of a card.
    read_only : bool
        Whether nothing is written through them.
    peers : str or sequence of str, optional
        Addresses and networks from which masters of Modbus are accepted; all if left out.
    anonymous : bool
        Whether anybody may read by OPC UA, without a name and without security.
    client : str, optional
        The address of a PLC that is a server itself, "modbus://HOST:PORT?unit=1" or
        "opc.tcp://HOST:PORT": the rig writes what the plant shows there, and reads the commands.
    client_map : str or Path, optional
        Of a CSV file: where that PLC has which tag.
    """

    open: Collection[str] | None = None
    ports: Mapping[str, int] | None = None
    host: str = LOOPBACK
    registers: str | Path | None = None
    encoding: str = "float32"
    read_only: bool = False
    peers: str | Sequence[str] | None = None
    anonymous: bool = False
    client: str | None = None
    client_map: str | Path | None = None

    def made(self, rig: Rig, settings: RigSettings) -> tuple[Door, ...]:
        """Return the doors of a rig.

        Parameters
        ----------
        rig : Rig
            Of the laboratory, of which the settings are.
        settings : RigSettings

        Raises
        ------
        InputError
            There is no such door, it is not installed, or what it needs is wrong.
        """
        ports = dict(self.ports or {})
        for name in (*(self.open or ()), *ports):
            require_known("rig, doors", name, list(PACKAGES))
        lacking = doors_without_package()
        for name in self.open or ():
            require_packages("rig, doors", *PACKAGES[name])
        asked = PACKAGES if self.open is None else self.open
        found = {name for name in asked if name not in lacking}
        doors: list[Door] = []
        tags, folder, seed = settings.tags, settings.folder, settings.plant.seed
        if "modbus" in found:
            from clepsydra.rig.doors.modbus.door import DEFAULT_PORT, ModbusDoor

            if not (self.is_loopback or self.read_only or self.peers):
                raise InputError(
                    "rig, host", self.host, "who may write by Modbus, which asks for no password",
                    'name the PLC, as in peers="192.168.0.10", or make it read-only',
                )  # fmt: skip
            doors.append(
                ModbusDoor(
                    self.register_map(tags), self.host, ports.get("modbus", DEFAULT_PORT),
                    read_only=self.read_only, seed=seed,
                    peers=self._peers,
                )
            )  # fmt: skip
        if "opc-ua" in found:
            from clepsydra.rig.doors.opc_ua.door import PORT, OpcUaDoor
            from clepsydra.rig.tag import Writer

            # Through a door that takes nothing all tags are the plant's.
            shown = [replace(tag, writer=Writer.PLANT) for tag in tags] if self.read_only else tags
            doors.append(
                OpcUaDoor(
                    folder / "opc-ua", tuple(shown), self.host, ports.get("opc-ua", PORT),
                    self.anonymous, settings.plant.silence, seed,
                )
            )  # fmt: skip
        if "page" in found:
            from clepsydra.rig.doors.page.door import DEFAULT_PORT as PAGE_PORT
            from clepsydra.rig.doors.page.opening import page_door

            doors.append(
                page_door(
                    rig, settings.plant, tags, folder, speed=settings.speed, host=self.host,
                    port=ports.get("page", PAGE_PORT), view_only=self.read_only,
                )
            )  # fmt: skip
        if self.client is not None:
            sample = settings.process.sampling_period / settings.speed
            doors.append(
                client_door(self.client, self.client_map, tags, folder, sample=sample, seed=seed)
            )
        elif self.client_map is not None:
            remedy = 'give the address of the PLC too, as in client="modbus://192.168.0.10"'
            raise InputError("rig, client", Finding("a map alone"), "whose map it is", remedy)
        return tuple(doors)

    @property
    def _peers(self) -> tuple[str, ...] | None:
        if self.peers is None:
            return None
        return (self.peers,) if isinstance(self.peers, str) else tuple(self.peers)

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine reaches them."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"

    def register_map(self, tags: Sequence[Tag]) -> RegisterMap:
        """Return the register map, from its file or made of the tags."""
        from clepsydra.rig.doors.modbus.encoding import Encoding
        from clepsydra.rig.doors.modbus.map_file import read_map
        from clepsydra.rig.doors.modbus.register_map import default_map

        if self.registers is not None:
            return read_map(Path(self.registers), tags)
        encodings = {each.value: each for each in Encoding if each.is_of_values}
        require_known("rig, encoding", self.encoding, list(encodings))
        return default_map(tags, encodings[self.encoding])


#: All doors that are installed, for this machine alone.
INSTALLED = Doors()
