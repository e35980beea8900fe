"""The tags of a rig as nodes of an OPC UA server: folders, types, units, ranges and access."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from clepsydra.base.errors import InputError
from clepsydra.rig.doors.opc_ua.engineering_units import UNECE, engineering_unit
from clepsydra.rig.tag import Tag, Writer

if TYPE_CHECKING:
    from asyncua import Node, Server, ua

#: Where the names of the nodes are from.
NAMESPACE = "urn:clepsydra:rig"
#: The folder of all tags in Objects.
_ROOT, _TITLE = "/", "Rig"
#: Characters of a browse name at most (OPC 10000-3, 8.3).
_LONGEST_NAME = 512


def check_names(tags: Iterable[Tag]) -> None:
    """Refuse tags that OPC UA cannot name.

    Raises
    ------
    InputError
        A name is empty or too long, or two tags of one folder have the same (OPC 10000-3, 4.5.4:
        a client finds a node by the names on the way to it).
    """
    tags = tuple(tags)
    for tag in tags:
        if not 0 < len(tag.label) <= _LONGEST_NAME:
            raise InputError(
                f"tag of {tag.name}", tag.label, f"a name of 1 to {_LONGEST_NAME} characters",
                "change it in [tags] of the process file",
            )  # fmt: skip
    for (folder, label), count in Counter((folder_of(tag), tag.label) for tag in tags).items():
        if count > 1:
            names = " and ".join(
                tag.name for tag in tags if (folder_of(tag), tag.label) == (folder, label)
            )
            raise InputError(
                f"tags of {names}", label, "a name of its own for each, as OPC UA has folders",
                "change one of them in [tags] of the process file",
            )  # fmt: skip


def folder_of(tag: Tag) -> str:
    """Return the element that a tag belongs to; empty for none.

    >>> from clepsydra.base.signal import Signal
    >>> folder_of(Tag("pump_1.out", "P1_out", Signal("pump_1.out"), Writer.CONTROLLER, "c", "1"))
    'pump_1'
    """
    return tag.name.rpartition(".")[0]


async def add_tags(server: Server, tags: Sequence[Tag]) -> dict[str, ua.NodeId]:
    """Give a server the nodes of tags, by the names of the tags.

    The identifier of a node is the name of its tag, and stays what it is when tags of the process
    file are changed; the browse name is what the control system calls it.
    """
    from asyncua import ua

    index = await server.register_namespace(NAMESPACE)
    objects = server.get_objects_node()
    root = await objects.add_folder(ua.NodeId(_ROOT, index), ua.QualifiedName(_TITLE, index))
    folders: dict[str, Node] = {"": root}
    nodes = {}
    for tag in tags:
        folder = folder_of(tag)
        if folder not in folders:
            identifier = ua.NodeId(_ROOT + folder, index)
            folders[folder] = await root.add_folder(identifier, ua.QualifiedName(folder, index))
        nodes[tag.name] = await _added(folders[folder], tag, index)
    return nodes


def data_type(tag: Tag) -> ua.VariantType:
    """Return the type of a tag's value: Double, Boolean, UInt16, or UInt32 of a status word."""
    from asyncua import ua

    types = ua.VariantType
    whole = types.UInt16 if tag.signal.high <= 0xFFFF else types.UInt32
    kinds = {"real": types.Double, "integer": whole, "boolean": types.Boolean}
    return kinds[tag.signal.kind]


async def _added(folder: Node, tag: Tag, index: int) -> ua.NodeId:
    from asyncua import Node, ua

    access = ua.AccessLevel.CurrentRead.mask
    if tag.writer is not Writer.PLANT:
        access |= ua.AccessLevel.CurrentWrite.mask
    about = ua.VariableAttributes()
    about.DisplayName = ua.LocalizedText(tag.label)
    about.Description = ua.LocalizedText(tag.signal.description)
    about.DataType = ua.NodeId(data_type(tag).value)
    about.ValueRank = ua.ValueRank.Scalar
    about.Value = ua.Variant(None, ua.VariantType.Null)
    about.AccessLevel = about.UserAccessLevel = access
    about.Historizing = False
    item = ua.AddNodesItem()
    item.RequestedNewNodeId = ua.NodeId(tag.name, index)
    item.BrowseName = ua.QualifiedName(tag.label, index)
    item.NodeClass = ua.NodeClass.Variable
    item.ParentNodeId = folder.nodeid
    item.ReferenceTypeId = ua.NodeId(ua.ObjectIds.HasComponent)
    item.TypeDefinition = ua.NodeId(_type_of(tag))
    item.NodeAttributes = about
    (result,) = await folder.session.add_nodes([item])
    result.StatusCode.check()
    node = Node(folder.session, result.AddedNodeId)
    for name, value in _properties(tag).items():
        await node.add_property(
            ua.NodeId(f"{tag.name}/{name}", index), ua.QualifiedName(name, 0), value
        )
    return node.nodeid


def _type_of(tag: Tag) -> int:
    """Return the type of a tag's node (OPC 10000-8, 5.3)."""
    from asyncua import ua

    if tag.signal.kind == "boolean":
        return ua.ObjectIds.TwoStateDiscreteType
    if tag.signal.kind == "integer":
        return ua.ObjectIds.DataItemType
    # The first has to have a range, the second a unit.
    return ua.ObjectIds.AnalogItemType if tag.signal.has_range else ua.ObjectIds.AnalogUnitType


def _properties(tag: Tag) -> dict[str, object]:
    from asyncua import ua

    signal = tag.signal
    if signal.kind == "boolean":
        return {"FalseState": ua.LocalizedText("off"), "TrueState": ua.LocalizedText("on")}
    if signal.kind == "integer":
        return {}
    unit = engineering_unit(signal.unit)
    found: dict[str, object] = {
        "EngineeringUnits": ua.EUInformation(
            UNECE, unit.code, ua.LocalizedText(unit.shown), ua.LocalizedText(unit.words)
        )
    }
    if signal.has_range:
        found["EURange"] = ua.Range(signal.low, signal.high)
        # What cards show, beyond the ends of the range too.
        found["InstrumentRange"] = ua.Range(tag.lowest, tag.highest)
    return found
