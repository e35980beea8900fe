/** Attaches a page to its rig: shows nothing of the plant before it is heard, and says when it no longer is. */

import { unpacked } from "../../live/bytes.ts";
import type { AttachedData, Hand } from "../data.ts";
import { Flows } from "../flows.ts";
import { AttachedLab } from "./attached_lab.ts";
import { AttachedRig } from "./attached_rig.ts";
import { Link } from "./link.ts";
import { ageWords, alarmWords, type Standing } from "./standing.ts";

/** How often it is looked at whether what is seen is still so [ms]. */
const LOOK = 250;

export async function attach(data: AttachedData, at: (id: string) => HTMLElement): Promise<void> {
  const modules = await Promise.all(data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
  const flows = data.flows ? new Flows(modules[data.flows.module]!, data.flows) : undefined;
  const rig = new AttachedRig(data, (hand: Hand) => link.send(hand));
  const begun = performance.now();
  const { period } = data;
  const { plant, speed } = data.attached;
  let lab: AttachedLab | undefined;
  let [came, isAnother, isViewer] = [begun, false, false];
  const standing = (): Standing => ({
    isOpen: link.isOpen, isAnother, isViewer, age: (performance.now() - came) / 1000, period: period / speed,
    isRemote: rig.hasSamples && rig.isRemote, heard: rig.hasSamples ? rig.heard : "none", isPast: rig.hasSamples && rig.isPast,
  });
  const alarm = at("link");
  const [words, age] = [document.createElement("span"), document.createElement("span")];
  // It counts; that need not be heard each time.
  age.setAttribute("aria-hidden", "true");
  alarm.append(words, age);
  const look = (): void => {
    const now = standing();
    const found = alarmWords(now);
    if (words.textContent !== found) words.textContent = found;
    age.textContent = rig.hasSamples ? ageWords(now) : "";
    alarm.hidden = found === "";
    lab?.soon();
  };
  const address = (): string => {
    const url = new URL("/rig", location.href);
    url.protocol = url.protocol.replace("http", "ws");
    if (rig.lastSample) url.searchParams.set("since", String(rig.lastSample - 1));
    return url.href;
  };
  const link: Link = new Link(address, {
    met: (hello) => {
      isAnother = hello.plant !== plant;
      isViewer = hello.isViewer;
      if (isAnother) link.end();
      else rig.meet(hello);
    },
    samples: (rows) => {
      if (isAnother) return;
      rig.take(rows);
      came = performance.now();
      lab ??= new AttachedLab(data, rig, flows, at, standing);
      lab.moved();
    },
    delayed: (sample, values) => rig.comesOut(sample, values),
    taken: (hand, sample) => rig.taken(hand, sample),
    refused: (hand, why) => {
      rig.refused(hand);
      lab?.say(`Refused: ${why}.`);
      lab?.soon();
    },
    pages: (count) => lab?.visitors(count),
    turned: look,
  });
  setInterval(look, LOOK);
}
