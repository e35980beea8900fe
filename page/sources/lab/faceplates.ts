/** The faceplates: one a loop of who has the rig, and one for what no loop moves. */

import type { LabData, LoopData, ShownSignal } from "./data.ts";
import { Knob } from "./knob.ts";
import { share, shownText } from "./quantities.ts";
import type { Rig } from "./rig.ts";

const [MANUAL, AUTOMATIC] = [0, 1];

export class Faceplates {
  private readonly place: HTMLElement;
  private readonly rig: Rig;
  private readonly signals: Map<string, ShownSignal>;
  private readonly changed: () => void;
  private readonly refuse: (words: string) => void;
  private updates: (() => void)[] = [];

  constructor(place: HTMLElement, rig: Rig, signals: Map<string, ShownSignal>, changed: () => void, refuse: (words: string) => void) {
    this.place = place;
    this.rig = rig;
    this.signals = signals;
    this.changed = changed;
    this.refuse = refuse;
    this.build();
  }

  /** Build them for who has the rig now. */
  build(): void {
    const data: LabData = this.rig.data;
    const { loops } = data.controllers[this.rig.controller]!;
    this.updates = [];
    const moved = new Set(loops.flatMap((loop) => loop.moves));
    const plates = loops.map((loop) => this.plate(loop));
    const byHand = data.inputs.filter((name) => !moved.has(name));
    if (byHand.length) plates.push(this.group("By hand", byHand.map((name) => this.hand(name, `${name}.manual`))));
    if (data.disturbances.length)
      plates.push(this.group("Disturbances", data.disturbances.map((name) => this.hand(name, name))));
    this.place.replaceChildren(...plates);
    this.show();
  }

  show(): void {
    for (const update of this.updates) update();
  }

  private plate({ controls, moves }: LoopData): HTMLElement {
    const rows = controls.map((name) => this.controlled(name));
    return this.group([...controls, ...moves].join(" · "), [...rows, ...moves.map((name) => this.actuator(name))]);
  }

  private controlled(name: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const row = this.row(name, "PV", signal, () => this.rig.value(name));
    row.append(this.knob(`Setpoint of ${name}`, "SP", signal, `${name}.setpoint`));
    return row;
  }

  private actuator(name: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const row = this.row(name, "OP", signal, () => this.rig.value(name));
    const modes = element("div", "modes");
    modes.setAttribute("role", "group");
    modes.setAttribute("aria-label", `Mode of ${name}`);
    const isManual = (): boolean => this.rig.value(`${name}.mode`) === MANUAL;
    for (const [title, mode] of [["Auto", AUTOMATIC], ["Manual", MANUAL]] as const) {
      const button = element("button", "", title);
      button.addEventListener("click", () => {
        // Manual begins where the output stands.
        if (mode === MANUAL && !isManual()) this.rig.touch(`${name}.manual`, this.rig.value(name));
        this.rig.touch(`${name}.mode`, mode);
        this.changed();
      });
      this.updates.push(() => button.setAttribute("aria-pressed", String(isManual() === (mode === MANUAL))));
      modes.append(button);
    }
    const manual = this.knob(`Manual value of ${name}`, "", signal, `${name}.manual`, isManual);
    row.append(modes, manual);
    return row;
  }

  private hand(name: string, input: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const row = element("div", "signal");
    row.append(element("b", "", name), this.knob(name, "", signal, input));
    if (signal.words) row.title = signal.words;
    return row;
  }

  /** Return a signal with its bar, its number and its share of the range. */
  private row(name: string, what: string, signal: ShownSignal, value: () => number): HTMLElement {
    const row = element("div", "signal");
    const head = element("p", "head");
    const number = element("span", "number", "");
    head.append(element("abbr", "", what), element("b", "", name), number);
    const bar = element("div", "bar");
    const filled = element("i", "");
    bar.append(filled);
    bar.setAttribute("aria-hidden", "true");
    row.append(head, bar);
    if (signal.low !== null && signal.high !== null) {
      const range = element("p", "range");
      range.append(...[signal.low, signal.high].map((end) => element("span", "", shownText(signal, end))));
      row.append(range);
    }
    this.updates.push(() => {
      const now = value();
      const part = share(signal, now);
      const end = part === undefined ? "" : part <= 0 ? " at its lowest" : part >= 1 ? " at its highest" : "";
      const text = shownText(signal, now) + end;
      if (number.textContent !== text) number.textContent = text;
      row.classList.toggle("abnormal", end !== "");
      filled.style.width = `${100 * Math.min(1, Math.max(0, part ?? 0))}%`;
    });
    return row;
  }

  private knob(label: string, what: string, signal: ShownSignal, input: string, isInHand = () => true): HTMLElement {
    const rest = this.rig.value(input);
    const low = signal.low ?? Math.min(0, 2 * rest);
    const high = signal.high ?? Math.max(2 * Math.abs(rest), low + 1 / signal.factor);
    const knob = new Knob(label, signal, [low, high], (value) => {
      // A typed number takes the output in hand.
      if (!isInHand()) this.rig.touch(input.replace(/manual$/, "mode"), MANUAL);
      this.rig.touch(input, value);
      this.changed();
    }, this.refuse);
    if (what) knob.place.prepend(element("abbr", "", what));
    this.updates.push(() => knob.show(this.rig.value(isInHand() ? input : input.replace(/\.manual$/, "")), isInHand()));
    return knob.place;
  }

  private group(title: string, rows: HTMLElement[]): HTMLElement {
    const plate = element("section", "faceplate");
    plate.setAttribute("aria-label", title);
    plate.append(element("h2", "", title), ...rows);
    return plate;
  }
}

export function element<K extends keyof HTMLElementTagNameMap>(tag: K, kind: string, words?: string): HTMLElementTagNameMap[K] {
  const found = document.createElement(tag);
  if (kind) found.className = kind;
  if (words !== undefined) found.textContent = words;
  return found;
}
