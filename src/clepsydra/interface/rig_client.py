"""The rig as the client of a PLC: from an address and a map to the door that does it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import SplitResult, parse_qsl, urlsplit

from clepsydra.base.arguments import require_known
from clepsydra.base.errors import Finding, InputError
from clepsydra.rig.doors.packages import require_packages

if TYPE_CHECKING:
    from clepsydra.rig.doors.door import Door
    from clepsydra.rig.tag import Tag

_PLACE = "rig, client"
_EXAMPLES = "modbus://192.168.0.10?unit=1 or opc.tcp://192.168.0.10:4840"
_MODBUS_PORT, _ANY_UNIT = 502, 255
#: Exchanges in a sample of the plant, and how often at most and at least [s]: what a PLC answers
#: to one is read by the next.
_EXCHANGES, _FASTEST, _SLOWEST = 5.0, 0.005, 0.1
_MODBUS_KEYS = ("unit",)
_OPC_UA_KEYS = ("policy", "certificate", "user", "password-file")


def client_door(
    address: str, client_map: str | Path | None, tags: Sequence[Tag], folder: Path, *,
    sample: float, seed: int,
) -> Door:  # fmt: skip
    """Return the door by which a rig reads and writes a PLC.

    Parameters
    ----------
    address : str
        "modbus://HOST[:PORT][?unit=NUMBER]", or "opc.tcp://HOST:PORT[/PATH]" with "policy",
        "certificate", "user" and "password-file" behind a question mark.
    client_map : str or Path, optional
        Of a CSV file: where the PLC has which tag.
    tags : sequence of Tag
    folder : Path
        Of the rig: its own certificate as a client of OPC UA is made there.
    sample : float
        What a sample of the plant takes on the clock [s].
    seed : int
        Of which exchanges are lost where an instructor lets requests be lost.

    Raises
    ------
    InputError
        It is no such address, or the map is missing or cannot be used.

    Examples
    --------
    >>> import tempfile
    >>> import clepsydra as cl
    >>> from clepsydra.rig.tags import tags_of
    >>> tags = tags_of(cl.load("quadruple-tank").point)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "plc.csv")
    ...     _ = file.write_text("tag,table,address,encoding\\n"
    ...                         "level_1.pv,holding register,1024,counts-65535\\n"
    ...                         "pump_1.out,holding register,0,counts-65535\\n")
    ...     door = client_door("modbus://192.168.0.10?unit=1", file, tags, Path(folder),
    ...                        sample=1.0, seed=1)
    >>> door.title, door.address
    ('Modbus TCP client', '192.168.0.10:502')
    """
    parts = _split(address)
    if client_map is None:
        raise InputError(
            "rig, client_map", Finding("no map"), "where the PLC has which tag",
            "give a CSV file with the columns "
            + ("tag, node" if parts.scheme == "opc.tcp" else "tag, table, address, encoding"),
        )  # fmt: skip
    period = min(max(sample / _EXCHANGES, _FASTEST), _SLOWEST)
    build = _opc_ua if parts.scheme == "opc.tcp" else _modbus
    return build(parts, Path(client_map), tags, folder, period, seed)


def _split(address: str) -> SplitResult:
    """Return the parts of an address, or refuse it."""
    refused = InputError(_PLACE, address, "the address of a PLC", f"write as in {_EXAMPLES}")
    try:
        parts = urlsplit(address)
        port = parts.port
    except ValueError:
        raise refused from None
    if parts.scheme not in ("modbus", "opc.tcp") or not parts.hostname:
        raise refused
    if parts.password is not None or parts.username is not None:
        remedy = "leave it out of the address; of OPC UA write ?user=NAME&password-file=FILE"
        raise InputError(_PLACE, parts.hostname, "an address without a user in it", remedy)
    if parts.scheme == "modbus" and (parts.path not in ("", "/") or port == 0):
        raise refused
    return parts


def _asked(parts: SplitResult, known: Sequence[str]) -> dict[str, str]:
    """Return what stands behind the question mark of an address."""
    found = dict(parse_qsl(parts.query, keep_blank_values=True))
    for key in found:
        require_known(_PLACE, key, known)
    return found


def _modbus(
    parts: SplitResult, client_map: Path, tags: Sequence[Tag], folder: Path, period: float,
    seed: int,
) -> Door:  # fmt: skip
    from clepsydra.rig.doors.modbus.client_door import ModbusClientDoor
    from clepsydra.rig.doors.modbus.map_file import read_map
    from clepsydra.rig.doors.modbus.register_map import Server

    unit = _asked(parts, _MODBUS_KEYS).get("unit", str(_ANY_UNIT))
    if not (unit.isascii() and unit.isdecimal()):
        remedy = "write as in modbus://192.168.0.10?unit=1"
        raise InputError(_PLACE, unit, "a unit identifier from 0 to 255", remedy)
    host = parts.hostname or ""
    return ModbusClientDoor(
        read_map(client_map, tags, Server.PLC), host, parts.port or _MODBUS_PORT, period,
        int(unit), seed=seed,
    )  # fmt: skip


def _opc_ua(
    parts: SplitResult, client_map: Path, tags: Sequence[Tag], folder: Path, period: float,
    seed: int,
) -> Door:  # fmt: skip
    from clepsydra.rig.doors.opc_ua.client import Access
    from clepsydra.rig.doors.opc_ua.client_door import OpcUaClientDoor
    from clepsydra.rig.doors.opc_ua.identity import Identity
    from clepsydra.rig.doors.opc_ua.node_map import read_node_map

    require_packages(_PLACE, "asyncua", "cryptography")
    asked = _asked(parts, _OPC_UA_KEYS)
    files = {key: Path(asked[key]) for key in ("certificate", "password-file") if key in asked}
    access = Access(
        parts._replace(query="", fragment="").geturl(),
        Identity(folder / "opc-ua-client", "client"), files.get("certificate"),
        asked.get("user", ""), files.get("password-file"), asked.get("policy", "Basic256Sha256"),
    )  # fmt: skip
    return OpcUaClientDoor(access, read_node_map(client_map, tags), period, seed)
