/** The controllers that a reader brings, and the settings of the others, changed while the rig runs. */

import { copyOnClick } from "../copy.ts";
import { unpacked } from "../live/bytes.ts";
import { Sliders } from "../live/sliders.ts";
import { TriedSettings } from "../live/tried_settings.ts";
import { type Bench, type Brought, lawParameters } from "./brought.ts";
import { Dialog } from "./dialog.ts";
import { element } from "./faceplates.ts";
import { MatricesDialog } from "./matrices_dialog.ts";
import { Refused } from "./refused.ts";
import { regulatorOf } from "./regulator_file.ts";
import type { Rig } from "./rig.ts";
import type { Run } from "./run.ts";
import { TypedDialog } from "./typed_dialog.ts";

const [MANUAL, AUTOMATIC] = [0, 1];

/** What the laboratory does when a controller was brought. */
export interface Host {
  /** Go through a sample, in which a law follows with its new numbers. */
  step(): void;
  /** A controller can be chosen by this name. */
  offered(controller: number, title: string): void;
  /** A controller is in control from the next sample on, by this name. */
  chosen(controller: number, title: string): void;
  say(words: string): void;
}

export class Laws {
  private readonly place: HTMLElement;
  private readonly bench: Bench;
  private readonly rig: Rig;
  private readonly host: Host;
  private readonly typed: TypedDialog;
  private readonly matrices: MatricesDialog;
  private readonly list = element("ul", "brought");
  private readonly refused = new Dialog();
  private readonly settings = element("details", "settings");
  private readonly sliders = element("div", "");
  /** By the controller that has their numbers. */
  private readonly brought = new Map<number, Brought>();
  private readonly files: { name: string; content: ArrayBuffer }[] = [];
  private readonly tried = new Map<number, TriedSettings>();
  private shown = -1;
  private stood: { run: Run | undefined; sample: number } = { run: undefined, sample: 0 };

  constructor(place: HTMLElement, bench: Omit<Bench, "leading" | "held" | "switchOn">, rig: Rig, host: Host) {
    [this.place, this.rig, this.host] = [place, rig, host];
    this.bench = {
      ...bench, leading: () => rig.controller, held: (controller) => this.brought.get(controller)?.title,
      switchOn: (each) => this.switchOn(each),
    };
    this.typed = new TypedDialog(this.bench);
    this.matrices = new MatricesDialog(this.bench);
    const files = Object.assign(element("input", ""), { type: "file", accept: ".mat", hidden: true });
    files.setAttribute("aria-label", "MAT file of a regulator");
    files.addEventListener("change", () => {
      if (files.files?.[0]) void this.load(files.files[0]);
      files.value = "";
    });
    const type = button("PI or PID…", () => this.typed.open());
    type.disabled = !this.typed.isThere;
    const note = element("p", "note", "Or drop a MAT file with A, B, C and D, such as reg1.mat, anywhere on the page.");
    this.refused.body.setAttribute("role", "alert");
    this.refused.button("Close", () => this.refused.close());
    this.settings.append(element("summary", "", "Settings while it runs"), this.sliders);
    const buttons = element("p", "buttons");
    buttons.append(type, button("Load matrices…", () => files.click()), files);
    place.append(element("h2", "", "Controllers of your own"), buttons, note, this.list, this.settings);
    this.takeDrops();
    void this.unpackFiles();
    this.show();
  }

  /** Show the settings of who has the rig, as they are at this moment of the run. */
  show(): void {
    const { controller, run, sample } = this.rig;
    const isElsewhere = run !== this.stood.run || sample < this.stood.sample;
    this.stood = { run, sample };
    if (isElsewhere) this.adopt();
    if (controller === this.shown && !isElsewhere) return;
    this.shown = controller;
    const given = this.bench.laws.given[controller];
    const hasSome = given !== undefined && (given.loops.length > 0 || given.bolder.length > 0);
    this.settings.hidden = !hasSome;
    this.sliders.replaceChildren(...(hasSome ? [this.slidersOf(controller).place, this.copyButton(controller)] : []));
  }

  /** Lead the reader here. */
  focus(): void {
    this.place.scrollIntoView({ block: "center" });
    this.place.querySelector<HTMLButtonElement>("button:enabled")?.focus();
  }

  /** Return what a controller is called. */
  title(controller: number): string {
    return this.rig.title(this.bench.data.controllers[controller]!.name);
  }

  /** Let a controller that was brought have its numbers, where the run does not know them. */
  ready(controller: number): void {
    const brought = this.brought.get(controller);
    if (!brought) return;
    const known = this.known(controller);
    if (Object.entries(brought.settings).every(([name, value]) => known[name] === value)) return;
    this.give(brought);
    this.host.step();
  }

  /** A new run begins: laws keep the numbers that they were given. */
  begun(): void {
    for (const brought of this.brought.values()) this.give(brought);
    for (const [controller, tried] of this.tried) if (!tried.isAsBefore) this.take(controller, tried);
  }

  /** Return the settings that the run has given a controller up to where it stands. */
  private known(controller: number, sample = this.rig.sample): Record<string, number> {
    const { run, data } = this.rig;
    const found: Record<string, number> = {};
    for (const touch of run.touches.slice(0, run.touchesBefore(sample)))
      if ("settings" in touch && touch.of === data.controllers[controller]!.name) Object.assign(found, touch.settings);
    return found;
  }

  /** Take what was brought in a run that is opened: its numbers are there, though not their file. */
  private adopt(): void {
    const { rig, bench } = this;
    for (const law of bench.laws.free) {
      const { name } = bench.data.controllers[law.controller]!;
      const title = rig.run.titles[name];
      if (title === undefined || this.brought.get(law.controller)?.title === title) continue;
      const settings = this.known(law.controller, rig.run.samples);
      this.brought.set(law.controller, { law, title, words: "of this run", settings, moves: bench.data.inputs, start: "bumpless" });
      this.host.offered(law.controller, title);
    }
    this.showList();
  }

  private slidersOf(controller: number): Sliders {
    const { data, laws } = this.bench;
    const parameters = lawParameters(data, controller);
    const values = parameters.map(([, value]) => value);
    const tried = new TriedSettings({ name: data.controllers[controller]!.title, values, ...laws.given[controller]! });
    const known = this.known(controller);
    for (const setting of tried.controller.loops.flatMap(({ settings }) => settings)) {
      const [place] = setting.values;
      const value = known[parameters[place!]![0]] ?? values[place!]!;
      if (value !== values[place!]) tried.set(setting, value / setting.factor);
    }
    this.tried.set(controller, tried);
    return new Sliders(tried, () => this.take(controller, tried));
  }

  private copyButton(controller: number): HTMLElement {
    const copy = element("button", "", "Copy these settings");
    copyOnClick(copy, () => this.tried.get(controller)!.text);
    return copy;
  }

  /** Let a controller have the settings of the sliders. */
  private take(controller: number, tried: TriedSettings): void {
    const parameters = lawParameters(this.bench.data, controller);
    const { loops, bolder } = tried.controller;
    const places = [...loops.flatMap(({ settings }) => settings.flatMap(({ values }) => values)), ...bolder.map(([place]) => place)];
    const { values } = tried;
    this.rig.settings(controller, Object.fromEntries(places.map((place) => [parameters[place]![0], values[place]!])));
  }

  private switchOn(brought: Brought): void {
    const { rig, host } = this;
    const { controller } = brought.law;
    this.give(brought);
    this.brought.set(controller, brought);
    this.showList();
    // Loops that are in control only change; other matrices have to find their states anew.
    if (controller === rig.controller && brought.law.kind === "pid") {
      host.chosen(controller, brought.title);
      host.say(`${brought.title}: new settings from the next sample on.`);
      return;
    }
    for (const name of this.bench.data.inputs) {
      const isMoved = brought.moves.includes(name);
      if (!isMoved && rig.value(`${name}.mode`) !== MANUAL) rig.touch(`${name}.manual`, rig.value(name));
      rig.touch(`${name}.mode`, isMoved ? AUTOMATIC : MANUAL);
    }
    // Its numbers are new: it has not followed with them.
    rig.choose(controller, brought.start === "bumpless" ? "settled" : brought.start);
    host.chosen(controller, brought.title);
  }

  /** Let a controller have the numbers that were brought for it, and their name. */
  private give({ law, title, settings }: Brought): void {
    this.rig.settings(law.controller, settings);
    this.rig.call(law.controller, title);
  }

  private showList(): void {
    this.list.replaceChildren(
      ...this.files.map(({ name, content }) => {
        const line = element("li", "");
        line.append(element("b", "", name), " is included in this page ", button("Ask and switch on…", () => void this.load(new File([content], name))));
        return line;
      }),
      ...[...this.brought.values()].map((brought) => {
        const line = element("li", "");
        const change = brought.again ? [button("Change…", () => brought.again!())] : [];
        line.append(element("b", "", brought.title), ` ${brought.words} `, ...change);
        return line;
      }),
    );
  }

  private takeDrops(): void {
    const isFile = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
    addEventListener("dragover", (event) => {
      if (isFile(event)) event.preventDefault();
    });
    addEventListener("drop", (event) => {
      if (!isFile(event)) return;
      event.preventDefault();
      const file = event.dataTransfer?.files[0];
      // A session is another's.
      if (file && !file.name.endsWith(".json")) void this.load(file);
    });
  }

  private async unpackFiles(): Promise<void> {
    for (const { name, content } of this.bench.laws.files ?? []) this.files.push({ name, content: await unpacked(content) });
    this.showList();
  }

  private async load(file: File): Promise<void> {
    try {
      const given = await regulatorOf(file.name, new Uint8Array(await file.arrayBuffer()));
      this.matrices.open(given);
    } catch (error) {
      const words = error instanceof Refused ? error.message : `${file.name} cannot be read.`;
      this.refused.body.replaceChildren(element("p", "watch", words));
      this.refused.show(`${file.name} is not loaded`);
    }
  }
}

function button(words: string, action: () => void): HTMLButtonElement {
  const found = element("button", "", words);
  found.addEventListener("click", action);
  return found;
}
