#!/usr/bin/env bash
# A client that has lost its connection makes a new one and takes its subscriptions along by
# TransferSubscriptions (OPC 10000-4, 5.14.7). The server of asyncua then sends their notifications
# on the new connection, as it should, but as answers to the publish requests of the old one: it
# changes where results go and not where requests are taken from. To the new client they answer
# what it never asked; asyncua's own client hears nothing, and its publish request stays open.
# Expected: after the transfer the second connection hears of every value that is written.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check asyncua==2.1.0
"$folder/venv/bin/python" - <<'PYTHON'
import asyncio
import logging
import sys
from importlib.metadata import version

from asyncua import Client, Server, ua

print("asyncua", version("asyncua"))
logging.getLogger("asyncua").setLevel(logging.CRITICAL)
VALUES = (1.0, 2.0, 3.0)


class Heard(list):
    def datachange_notification(self, node, value, data):
        self.append(value)


async def main():
    server = Server()
    await server.init()
    server.set_endpoint("opc.tcp://127.0.0.1:0/finding")
    server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
    level = await server.nodes.objects.add_variable(2, "level", 0.0)
    await server.start()
    url = f"opc.tcp://127.0.0.1:{server.bserver.port}/finding"
    first, second, heard, answers = Client(url), Client(url), Heard(), []
    await first.connect()
    subscription = await first.create_subscription(50, heard)
    await subscription.subscribe_data_change(first.get_node(level.nodeid))
    while not heard:
        await asyncio.sleep(0.05)
    await second.connect()
    (transferred,) = await second.uaclient.transfer_subscriptions(
        ua.TransferSubscriptionsParameters([subscription.subscription_id], True)
    )

    async def publish():
        while True:
            answers.append(await second.uaclient.publish([]))

    publishing = asyncio.create_task(publish())
    for value in VALUES:
        await asyncio.sleep(0.3)
        await level.write_value(value)
    await asyncio.sleep(0.5)
    told = [
        item.Value.Value.Value
        for answer in answers
        for data in answer.Parameters.NotificationMessage.NotificationData
        for item in data.MonitoredItems
    ]
    publishing.cancel()
    print(f"the server says of the transfer: {transferred.StatusCode.name}")
    print(f"values of the first connection before it: expected [0.0], seen {list(heard)}")
    print(f"values of the second one after it: expected {list(VALUES)}, seen {told}")
    for client in (second, first):
        try:
            await client.disconnect()
        except Exception:
            pass
    await server.stop()
    return transferred.StatusCode.is_good() and told == []


sys.exit(0 if asyncio.run(asyncio.wait_for(main(), 60)) else 1)
PYTHON
