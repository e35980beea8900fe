/** The page of a running rig: what the laboratory shows, of a plant that runs elsewhere. */

import { Acknowledging } from "../acknowledging.ts";
import { AlarmList } from "../alarm_list.ts";
import type { AttachedData, ShownSignal } from "../data.ts";
import { Drawing } from "../drawing.ts";
import { Faceplates } from "../faceplates.ts";
import type { Flows } from "../flows.ts";
import { Happened } from "../happened.ts";
import { levelled } from "../layout.ts";
import { Scrubber } from "../scrubber.ts";
import { type Shortcut, Shortcuts } from "../shortcuts.ts";
import { WIRES } from "../touch_words.ts";
import { Trends } from "../trends.ts";
import { TripBanner } from "../trips.ts";
import { acting } from "./acting.ts";
import type { AttachedRig } from "./attached_rig.ts";
import { NOISE } from "./cells.ts";
import { InstructorPanel } from "./instructor.ts";
import { LiveBar } from "./live_bar.ts";
import { heldWords, isStale, type Standing } from "./standing.ts";

/** Trends are drawn and words written anew after so long [ms]. */
const SELDOM = 120;

export class AttachedLab {
  private readonly data: AttachedData;
  private readonly rig: AttachedRig;
  private readonly flows: Flows | undefined;
  private readonly drawing: Drawing;
  private readonly happened: Happened;
  private readonly acknowledging: Acknowledging;
  private readonly alarms: AlarmList | undefined;
  private readonly tripped: TripBanner;
  private readonly panel: InstructorPanel;
  private readonly faceplates: Faceplates;
  private readonly trends: Trends;
  private readonly scrubber: Scrubber;
  private readonly bar: LiveBar;
  /** What moves the plant. */
  private readonly groups: HTMLFieldSetElement[];
  private readonly said: HTMLElement;
  private readonly standing: () => Standing;
  private pages = 1;
  /** Why hands might not move the plant, as it was told last. */
  private held = "";
  private told = 0;
  private isDue = false;

  /** @param at Returns an element of the page. @param standing Returns how the rig stands. */
  constructor(data: AttachedData, rig: AttachedRig, flows: Flows | undefined, at: (id: string) => HTMLElement, standing: () => Standing) {
    this.data = data;
    this.rig = rig;
    this.flows = flows;
    this.standing = standing;
    this.said = at("said");
    const signals = new Map<string, ShownSignal>(data.signals.map((each) => [each.name, each]));
    const { title } = data.controllers[0]!;
    const shown = (): void => this.soon();
    const say = (words: string): void => this.say(words);
    this.drawing = new Drawing(document.querySelector<HTMLElement>("figure[data-controller]")!, data, signals, flows);
    this.happened = new Happened(at("happened"), data, () => title);
    this.acknowledging = new Acknowledging(rig);
    this.tripped = new TripBanner(at("tripped"), data);
    const [faceplates, hands] = [acting(at("faceplates")), acting(at("hands"))];
    this.groups = [faceplates, hands];
    if (data.alarms.length) {
      const alarms = acting(at("alarms"));
      this.groups.push(alarms);
      this.alarms = new AlarmList(alarms, rig, this.acknowledging, shown);
    }
    this.faceplates = new Faceplates(faceplates, rig, signals, shown);
    this.panel = new InstructorPanel(hands, rig, signals, shown);
    at("hands").hidden = false;
    const source = () => ({ run: rig.run, sample: rig.sample, others: [] });
    this.trends = new Trends(at("trends"), data, signals, source, say, () => title);
    this.scrubber = new Scrubber(at("time"), rig, shown, "the plant goes on");
    this.bar = new LiveBar(at("bar"), {
      remote: (isRemote) => {
        rig.touch(WIRES.remote, Number(isRemote));
        say(isRemote ? "The controller on the wires moves the plant." : `The local panel moves the plant: ${title}.`);
        this.soon();
      },
      noise: (isOn) => (rig.noise(isOn), this.soon()),
      now: () => (rig.goTo(rig.run.history.count), this.soon()),
    });
    this.groups.push(this.bar.switches);
    new Shortcuts(at("bar"), this.shortcuts());
    levelled(at("happened"), at("rig"), at("faceplates"));
    this.show();
  }

  /** Samples have come. */
  moved(): void {
    if (!heldWords(this.standing())) this.acknowledging.step();
    this.soon();
  }

  visitors(pages: number): void {
    this.pages = pages;
    this.soon();
  }

  say(words: string): void {
    this.said.textContent = words;
  }

  /** Show it in the next frame. */
  soon(): void {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame((now) => {
      this.isDue = false;
      this.show(now);
    });
  }

  private shortcuts(): Shortcut[] {
    const { alarms, bar, faceplates } = this;
    return [
      {
        keys: [..."123456789"], told: "1 to 9", words: "To the first, second… faceplate",
        action: (key) => faceplates.focus(Number(key) - 1),
      },
      { keys: ["a"], told: "a", words: "The loop of this faceplate to automatic", action: () => faceplates.press("Auto") },
      { keys: ["m"], told: "m", words: "To manual", action: () => faceplates.press("Manual") },
      ...(alarms ? [{ keys: ["k"], told: "k", words: "Acknowledge all alarms", action: () => alarms.press() }] : []),
      { keys: ["n"], told: "n", words: "Noise on or off", action: () => bar.pressNoise() },
    ];
  }

  /** Show the rig as it stands, and what takes its time not at every sample. */
  private show(now = Infinity): void {
    const { rig, data } = this;
    const isTold = now - this.told > SELDOM;
    const value = (name: string): number => rig.value(name);
    this.flows?.update(rig);
    this.drawing.show(value, (name) => rig.parameter(name), isTold);
    this.faceplates.show(isTold);
    if (!isTold) return this.soon();
    this.told = now === Infinity ? 0 : now;
    this.panel.show();
    this.tripped.show(rig.run, rig.sample, value);
    this.scrubber.show();
    this.happened.show(rig.run, rig.sample);
    this.alarms?.show();
    this.trends.show();
    const standing = this.standing();
    const held = heldWords(standing);
    for (const group of this.groups) group.disabled = held !== "";
    document.body.classList.toggle("stale", isStale(standing));
    this.bar.show({
      time: rig.sample * data.period, speed: data.attached.speed, isRemote: rig.isRemote, heard: rig.heard,
      isNoisy: value(NOISE) !== 0, isPast: rig.isPast, isStale: isStale(standing), pages: this.pages,
      lateness: rig.now("plant.lateness"), missed: rig.now("plant.missed"), period: standing.period,
    });
    if (held !== this.held) this.say(held);
    this.held = held;
  }
}
