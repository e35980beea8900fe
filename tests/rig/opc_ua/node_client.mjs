// A client made of node-opcua that does what it is told, a line of JSON each, and answers each.
import { createRequire } from "node:module";
import { createInterface } from "node:readline";

const [folder, address, certificateFile, privateKeyFile, serverCertificate] = process.argv.slice(2);
const require = createRequire(`${folder}/`);
const opcua = require("node-opcua-client");
const { readFileSync } = require("node:fs");

let client, session, subscription, index;
const told = new Map();
const nodeId = (tag) => `ns=${index};s=${tag}`;
const status = (found) => found.statusCode.name;

const doings = {
  async open({ policy, mode, user, password, own }) {
    client = opcua.OPCUAClient.create({
      applicationName: "node-opcua",
      applicationUri: own,
      endpointMustExist: false,
      securityPolicy: opcua.SecurityPolicy[policy],
      securityMode: opcua.MessageSecurityMode[mode],
      certificateFile,
      privateKeyFile,
      serverCertificate: readFileSync(serverCertificate),
      connectionStrategy: { maxRetry: 0 },
    });
    await client.connect(address);
    const token = user
      ? { type: opcua.UserTokenType.UserName, userName: user, password }
      : { type: opcua.UserTokenType.Anonymous };
    session = await client.createSession(token);
    const names = await session.readNamespaceArray();
    index = names.indexOf("urn:clepsydra:rig");
    return names.length;
  },
  async read({ tag, property }) {
    const found = await session.read({
      nodeId: nodeId(property ? `${tag}/${property}` : tag),
      attributeId: opcua.AttributeIds.Value,
    });
    const value = found.value.value;
    return { value: value?.toJSON?.() ?? value, status: status(found), time: +found.sourceTimestamp / 1000 };
  },
  async write({ tag, type, value }) {
    const found = await session.write({
      nodeId: nodeId(tag),
      attributeId: opcua.AttributeIds.Value,
      value: { value: { dataType: opcua.DataType[type], value } },
    });
    return found.name;
  },
  async browse({ tag }) {
    const found = await session.browse(tag === "" ? `ns=${index};s=/` : `ns=${index};s=/${tag}`);
    return found.references.map((each) => each.browseName.name);
  },
  async watch({ tag, type, deadband }) {
    subscription ??= await session.createSubscription2({
      requestedPublishingInterval: 20,
      requestedLifetimeCount: 1000,
      requestedMaxKeepAliveCount: 10,
      maxNotificationsPerPublish: 0,
      publishingEnabled: true,
      priority: 1,
    });
    const filter = type && new opcua.DataChangeFilter({
      trigger: opcua.DataChangeTrigger.StatusValue,
      deadbandType: opcua.DeadbandType[type],
      deadbandValue: deadband,
    });
    const item = await subscription.monitor(
      { nodeId: nodeId(tag), attributeId: opcua.AttributeIds.Value },
      { samplingInterval: 0, queueSize: 100, discardOldest: true, filter },
      opcua.TimestampsToReturn.Both,
    );
    if (item.statusCode?.isNotGood?.()) return item.statusCode.name;
    told.set(tag, []);
    item.on("changed", (found) => told.get(tag).push([found.value.value, status(found)]));
    return "Good";
  },
  async told({ tag }) {
    return told.get(tag);
  },
  async close() {
    await session?.close();
    await client?.disconnect();
    return "closed";
  },
};

for await (const line of createInterface({ input: process.stdin })) {
  const { doing, ...given } = JSON.parse(line);
  let answer;
  try {
    answer = { found: await doings[doing](given) };
  } catch (error) {
    answer = { error: String(error?.message ?? error) };
    if (doing === "open") await client?.disconnect().catch(() => {});
  }
  process.stdout.write(`@${JSON.stringify(answer)}\n`);
  if (doing === "close") break;
}
process.exit(0);
