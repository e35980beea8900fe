"""A client reads and writes the tags of a rig."""

import asyncio
from datetime import UTC, datetime

import pytest
from tools import missing

pytestmark = pytest.mark.thorough

if not missing("asyncua", "cryptography"):
    from asyncua import ua
    from rig.opc_ua.clients import connected, node


def run(scenario):
    return asyncio.run(scenario())


async def read_until(client, name, holds):
    """Return what a tag shows as soon as it holds, for the door looks at the plant in its time."""
    found = await node(client, name).read_data_value(raise_on_bad_status=False)
    while not holds(found):
        await asyncio.sleep(0.01)
        found = await node(client, name).read_data_value(raise_on_bad_status=False)
    return found


def test_a_value_has_unit_range_time_and_words(rig):
    rig.show(level__pv=37.5)
    shown_at = datetime.fromtimestamp(rig.time - 1.0, UTC)

    async def scenario():
        async with connected(rig) as client:
            found = await read_until(client, "level.pv", lambda each: each.Value.Value == 37.5)
            level = node(client, "level.pv")
            properties = {
                (await each.read_browse_name()).Name: await each.read_value()
                for each in await level.get_properties()
            }
            path = ["0:Objects", f"{client.rig}:Rig", f"{client.rig}:level"]
            folder = await client.nodes.root.get_child(path)
            names = {(await each.read_browse_name()).Name for each in await folder.get_children()}
            words = await level.read_description()
            kinds = [
                (await node(client, name).read_type_definition()).Identifier
                for name in ("level.pv", "flow.pv", "level.good", "pump.status")
            ]
        return found, properties, names, words.Text, kinds

    found, properties, names, words, kinds = run(scenario)
    assert found.StatusCode.value == ua.StatusCodes.Good
    assert found.SourceTimestamp == shown_at
    assert properties["EngineeringUnits"].UnitId == int.from_bytes(b"CMT", "big")
    assert properties["EngineeringUnits"].DisplayName.Text == "cm"
    ends = properties["EURange"], properties["InstrumentRange"]
    assert (ends[0].Low, ends[0].High) == (0.0, 100.0)
    # Code 32511 of a card is the end where 27648 is that of the range.
    assert ends[1].High == pytest.approx(100.0 * 32511 / 27648, rel=1e-12)
    assert names == {"LEVEL_PV", "LEVEL_GOOD", "LEVEL_SP"}
    assert words == "words of level.pv"
    ids = ua.ObjectIds
    assert kinds == [
        ids.AnalogItemType, ids.AnalogUnitType, ids.TwoStateDiscreteType, ids.DataItemType
    ]  # fmt: skip


def test_the_status_says_what_the_sensor_says(rig):
    async def scenario():
        found = []
        async with connected(rig) as client:
            for values in (
                {"level__pv": 50.0},
                {"level__pv": 101.0},
                {"level__good": 0.0},
                {"level__good": 1.0, "level__pv": -0.5},
                {"level__pv": 100.0},
            ):
                rig.show(**values)
                sample = rig.sample - 1
                rig.show(plant__watchdog=float(sample))
                await read_until(
                    client, "plant.watchdog", lambda each, n=sample: each.Value.Value == n
                )
                each = await node(client, "level.pv").read_data_value(raise_on_bad_status=False)
                found.append((each.StatusCode.value, each.Value.Value))
        return found

    codes = ua.StatusCodes
    assert run(scenario) == [
        (codes.Good, 50.0),
        (codes.UncertainEngineeringUnitsExceeded, 101.0),
        (codes.BadSensorFailure, None),
        (codes.UncertainEngineeringUnitsExceeded, -0.5),
        (codes.Good, 100.0),
    ]


def test_what_is_written_is_what_the_plant_gets_and_what_is_read_back(rig):
    async def scenario():
        async with connected(rig) as client:
            await node(client, "pump.out").write_value(62.5)
            await node(client, "pump.status").write_value(ua.Variant(9, ua.VariantType.UInt16))
            await node(client, "operator.remote").write_value(True)
            names = ("pump.out", "pump.status", "operator.remote")
            return [await node(client, name).read_value() for name in names]

    assert run(scenario) == [62.5, 9, True]
    cells = ("pump.out", "pump.status", "operator.remote")
    assert [rig.image.read(cell) for cell in cells] == [62.5, 9.0, 1.0]


@pytest.mark.parametrize(
    ("name", "value", "kind", "code"),
    [
        ("level.pv", 1.0, "Double", "BadNotWritable"),
        ("pump.out", 120.0, "Double", "BadOutOfRange"),
        ("pump.out", float("nan"), "Double", "BadOutOfRange"),
        ("pump.out", float("-inf"), "Double", "BadOutOfRange"),
        ("pump.out", 5.0, "Float", "BadTypeMismatch"),
        ("pump.out", 5, "Int64", "BadTypeMismatch"),
        ("pump.out", "5", "String", "BadTypeMismatch"),
        ("pump.out", None, "Null", "BadTypeMismatch"),
        ("pump.out", [5.0], "Double", "BadTypeMismatch"),
        ("pump.status", True, "Boolean", "BadTypeMismatch"),
        ("operator.remote", 1, "UInt16", "BadTypeMismatch"),
        ("no.tag", 5.0, "Double", "BadNodeIdUnknown"),
    ],
)
def test_a_value_that_a_tag_does_not_take_is_refused_and_leaves_it(rig, name, value, kind, code):
    async def scenario():
        async with connected(rig) as client:
            await node(client, "pump.out").write_value(40.0)
            with pytest.raises(ua.UaStatusCodeError) as refused:
                await node(client, name).write_value(ua.Variant(value, ua.VariantType[kind]))
            return refused.value.code, await node(client, "pump.out").read_value()

    assert run(scenario) == (getattr(ua.StatusCodes, code), 40.0)


def test_only_values_are_written(rig):
    async def scenario():
        async with connected(rig) as client:
            found = []
            for of in (node(client, "pump.out"), client.get_node(ua.ObjectIds.Server_ServiceLevel)):
                for attribute in (ua.AttributeIds.DisplayName, ua.AttributeIds.Value):
                    if attribute is ua.AttributeIds.Value and of.nodeid.NamespaceIndex:
                        continue
                    words = ua.DataValue(ua.Variant(ua.LocalizedText("another")))
                    with pytest.raises(ua.UaStatusCodeError) as refused:
                        await of.write_attribute(attribute, words)
                    found.append(refused.value.code)
        return found

    assert run(scenario) == 3 * [ua.StatusCodes.BadNotWritable]


def test_more_writes_than_a_session_has_are_refused_and_a_pause_gives_it_more(rig):
    async def scenario():
        async with connected(rig) as client:
            nodes = 3000 * [node(client, "pump.out")]
            with pytest.raises(ua.UaStatusCodeError) as refused:
                await client.write_values(nodes, 3000 * [1.0])
            await asyncio.sleep(0.1)
            await node(client, "pump.out").write_value(2.0)
            return refused.value.code

    assert run(scenario) == ua.StatusCodes.BadTooManyOperations
