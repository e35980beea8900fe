"""The way of a controller to tags in a server of OPC UA."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clepsydra.rig.bus import BusFault
from clepsydra.rig.doors.opc_ua.identity import Identity
from clepsydra.rig.doors.opc_ua.limits import LONGEST_SESSION
from clepsydra.rig.doors.opc_ua.node_map import NodeMap
from clepsydra.rig.doors.opc_ua.trust import TrustList
from clepsydra.rig.doors.opc_ua.users import OPERATOR, PASSWORD

if TYPE_CHECKING:
    from asyncua import Client, ua

#: Those that are not deprecated.
POLICIES = ("Basic256Sha256", "Aes128Sha256RsaOaep", "Aes256Sha256RsaPss")
#: Of a request [s], so that a scan is late rather than never there.
_PATIENCE = 4.0
_BY_NAME = "nsu="
#: Of a node that will never be read; any other bad status says that its value is none now.
_NEVER = (
    *("BadNodeIdUnknown", "BadNodeIdInvalid", "BadNotReadable", "BadUserAccessDenied"),
    "BadAttributeIdInvalid",
)
#: The least and the largest number of each type of whole ones.
_WHOLE = {
    "SByte": (-(1 << 7), (1 << 7) - 1),
    "Byte": (0, (1 << 8) - 1),
    "Int16": (-(1 << 15), (1 << 15) - 1),
    "UInt16": (0, (1 << 16) - 1),
    "Int32": (-(1 << 31), (1 << 31) - 1),
    "UInt32": (0, (1 << 32) - 1),
    "Int64": (-(1 << 63), (1 << 63) - 1),
    "UInt64": (0, (1 << 64) - 1),
}


@dataclass(frozen=True)
class Access:
    """How a client comes into a server.

    Parameters
    ----------
    address : str
        "opc.tcp://127.0.0.1:4840/clepsydra".
    identity : Identity
        Of the client; made where there is none.
    server_certificate : Path, optional
        The server has to have its key; without it the one that the server shows is taken.
    user : str
        Empty for nobody.
    password_file : Path, optional
    policy : str
        One of `POLICIES`; "None" for a server that has no other.
    """

    address: str
    identity: Identity
    server_certificate: Path | None = None
    user: str = ""
    password_file: Path | None = field(default=None, repr=False)
    policy: str = "Basic256Sha256"


def access_to_rig(address: str, folder: Path, identity: Identity) -> Access:
    """Let a program of this machine into a rig's own server, as its operator.

    Parameters
    ----------
    address : str
        What the door reports once it can be reached.
    folder : Path
        Of the door's certificates.
    identity : Identity
        Of the program; the door trusts it from now on.
    """
    identity.make()
    TrustList(folder).add(identity.certificate)
    return Access(
        address, identity, Identity(folder, "rig").certificate, OPERATOR, folder / PASSWORD
    )


class OpcUaBus:
    """A client of a server of OPC UA that reads and writes tags.

    A value whose status is bad leaves the tag what it was, as the function blocks of PLCs do; one
    that was never there is not a number.

    Parameters
    ----------
    access : Access
    nodes : NodeMap
    """

    def __init__(self, access: Access, nodes: NodeMap) -> None:
        self._access, self._map = access, nodes
        self._client: Client | None = None
        self._found: dict[str, tuple[ua.NodeId, ua.VariantType]] = {}
        self._last: dict[str, float] = {}
        self._reads: tuple[Sequence[str], Any] = ((), None)

    async def open(self) -> None:
        """Connect.

        Raises
        ------
        BusFault
            Nobody is there, or it does not let the client in.
        """
        await self.close()
        try:
            await asyncio.wait_for(self._connect(), 5.0 * _PATIENCE)
        except Exception as error:
            await self.close()
            raise self._fault(error) from None

    async def _connect(self) -> None:
        from asyncua import Client, ua
        from asyncua.crypto import security_policies

        access = self._access
        # By itself it asks every second whether the server is there, and gives it a second.
        client = Client(access.address, timeout=_PATIENCE, watchdog_intervall=_PATIENCE)
        client.session_timeout = LONGEST_SESSION
        client.name = client.description = access.identity.application
        if access.policy != "None":
            access.identity.make()
            client.application_uri = access.identity.uri
            await client.set_security(
                getattr(security_policies, f"SecurityPolicy{access.policy}"),
                access.identity.certificate, access.identity.key,
                server_certificate=access.server_certificate,
                mode=ua.MessageSecurityMode.SignAndEncrypt,
            )  # fmt: skip
        if access.user:
            client.set_user(access.user)
        if access.password_file is not None:
            client.set_password(access.password_file.read_text("utf-8").strip())
        try:
            await client.connect()
        except BaseException:
            client.disconnect_socket()
            raise
        self._client = client
        self._found = await self._nodes(client)

    async def _nodes(self, client: Client) -> dict[str, tuple[ua.NodeId, ua.VariantType]]:
        """Find the nodes, each with the type of what the server takes for it."""
        from asyncua import ua

        names = await client.get_namespace_array()
        nodes = {
            name: ua.NodeId.from_string(_with_number(text, names))
            for name, text in self._map.nodes.items()
        }
        found = {}
        types = await self._attributes(client, list(nodes.values()), ua.AttributeIds.DataType)
        for (name, node), told in zip(nodes.items(), types, strict=True):
            if not told.StatusCode.is_good():
                raise BusFault(
                    self.title, name, f"{self._map.nodes[name]}: {told.StatusCode.name}",
                    answered=True,
                )  # fmt: skip
            found[name] = node, await _type_of(client, node, told.Value.Value)
        return found

    async def _attributes(
        self, client: Client, nodes: Sequence[ua.NodeId], attribute: ua.AttributeIds
    ) -> Any:
        from asyncua import ua

        wanted = ua.ReadParameters()
        wanted.NodesToRead = [ua.ReadValueId(node, attribute) for node in nodes]
        return await client.uaclient.read(wanted)

    @property
    def title(self) -> str:
        """What faults call it."""
        return f"OPC UA {self._access.address}"

    async def read(self, names: Iterable[str]) -> dict[str, float]:
        """Return the values of tags, in the units of their signals; 0 and 1 of switches.

        Raises
        ------
        BusFault
        """
        from asyncua.ua import StatusCodes

        client, asked = await self._ready(), tuple(names)
        told = await self._requested(client.uaclient.read(self._reading(asked)))
        for name, found in zip(asked, told, strict=True):
            if found.StatusCode.is_bad():
                if found.StatusCode.value in {getattr(StatusCodes, name) for name in _NEVER}:
                    raise BusFault(self.title, name, found.StatusCode.name, answered=True)
            elif isinstance(found.Value.Value, bool | int | float):
                self._last[name] = float(found.Value.Value)
        return {name: self._last.get(name, math.nan) for name in asked}

    def _reading(self, names: tuple[str, ...]) -> Any:
        """Return the request for some tags; a controller asks for the same ones every scan."""
        from asyncua import ua

        if self._reads[0] != names or self._reads[1] is None:
            self._known(names)
            wanted = ua.ReadParameters()
            wanted.NodesToRead = [
                ua.ReadValueId(self._found[name][0], ua.AttributeIds.Value) for name in names
            ]
            self._reads = names, wanted
        return self._reads[1]

    async def write(self, values: Mapping[str, float]) -> None:
        """Give tags values, in the units of their signals.

        A real number for a node of whole ones is rounded to the nearest.

        Raises
        ------
        BusFault
        """
        from asyncua import ua

        client = await self._ready()
        self._known(values)
        wanted = ua.WriteParameters()
        wanted.NodesToWrite = [
            ua.WriteValue(
                self._found[name][0], ua.AttributeIds.Value,
                Value=ua.DataValue(self._variant(name, value), StatusCode=None),
            )
            for name, value in values.items()
        ]  # fmt: skip
        results = await self._requested(client.uaclient.write(wanted))
        for name, result in zip(values, results, strict=True):
            if not result.is_good():
                raise BusFault(self.title, name, result.name, answered=True)

    def _variant(self, name: str, value: float) -> ua.Variant:
        """Return a value of the type that the server takes."""
        from asyncua import ua

        type_ = self._found[name][1]
        if type_ in (ua.VariantType.Double, ua.VariantType.Float):
            return ua.Variant(float(value), type_)
        if type_ is ua.VariantType.Boolean:
            return ua.Variant(value != 0.0, type_)
        low, high = _WHOLE[type_.name]
        if not low <= value <= high:
            raise BusFault(
                self.title, name, f"{value:g} does not go into {type_.name}", answered=True
            )
        return ua.Variant(round(value), type_)

    async def close(self) -> None:
        """Leave; what is closed already stays closed."""
        client, self._client = self._client, None
        if client is not None:
            try:
                await asyncio.wait_for(client.disconnect(), _PATIENCE)
            except Exception:
                client.disconnect_socket()

    async def _ready(self) -> Client:
        if self._client is None:
            await self.open()
        assert self._client is not None
        return self._client

    def _known(self, names: Iterable[str]) -> None:
        for name in names:
            if name not in self._found:
                raise BusFault(self.title, name, "it has no node", answered=True)

    async def _requested(self, request: Any) -> Any:
        try:
            return await asyncio.wait_for(request, _PATIENCE)
        except Exception as error:
            fault = self._fault(error)
            if not fault.answered:
                await self.close()
            raise fault from None

    def _fault(self, error: Exception) -> BusFault:
        from asyncua.ua.uaerrors import UaStatusCodeError

        if isinstance(error, BusFault):
            return error
        answered = isinstance(error, UaStatusCodeError)
        words = str(error) or type(error).__name__
        return BusFault(self.title, "", words, answered=answered)


async def _type_of(client: Client, node: ua.NodeId, told: ua.NodeId) -> ua.VariantType:
    """Return the type of a node's values: that of its data type, or of what stands there."""
    from asyncua import ua

    known = {kind.value: kind for kind in ua.VariantType}
    last = ua.VariantType.Double.value
    if told.NamespaceIndex == 0 and isinstance(told.Identifier, int) and told.Identifier <= last:
        return known[told.Identifier]
    found = await client.get_node(node).read_data_value(raise_on_bad_status=False)
    type_ = found.Value.VariantType
    if not 1 <= type_.value <= last:
        raise ValueError(f"{node.to_string()} holds no number: {type_.name}")
    return type_


def _with_number(text: str, namespaces: Sequence[str]) -> str:
    """Return the identifier of a node with the number of its namespace in the server."""
    if not text.startswith(_BY_NAME):
        return text
    uri, _, identifier = text.removeprefix(_BY_NAME).rpartition(";")
    if uri not in namespaces:
        raise ValueError(f"the server has no namespace {uri}")
    return f"ns={namespaces.index(uri)};{identifier}"
