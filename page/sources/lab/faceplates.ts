/** The faceplates: one a loop of who has the rig, and one for what no loop moves. */

import { AlarmBadge } from "./alarm_badge.ts";
import { alarmState, interlockWords } from "./alarm_states.ts";
import type { PlantData, LoopData, ShownSignal } from "./data.ts";
import { Knob } from "./knob.ts";
import { panelText, share, shownText } from "./quantities.ts";
import type { SeenRig } from "./seen_rig.ts";
import { isFault, sensorWords, statusWords } from "./states.ts";
import { tripWords } from "./trips.ts";

const [MANUAL, AUTOMATIC] = [0, 1];

export class Faceplates {
  private readonly place: HTMLElement;
  private readonly rig: SeenRig;
  private readonly signals: Map<string, ShownSignal>;
  private readonly changed: () => void;
  /** What moves, and what is read. */
  private moving: (() => void)[] = [];
  private told: (() => void)[] = [];

  constructor(place: HTMLElement, rig: SeenRig, signals: Map<string, ShownSignal>, changed: () => void) {
    this.place = place;
    this.rig = rig;
    this.signals = signals;
    this.changed = changed;
    this.build();
  }

  /** Build them for who has the rig now. */
  build(): void {
    const data: PlantData = this.rig.data;
    const { loops } = data.controllers[this.rig.controller]!;
    this.moving = [];
    this.told = [];
    const moved = new Set(loops.flatMap((loop) => loop.moves));
    const plates = loops.map((loop) => this.plate(loop));
    const byHand = data.inputs.filter((name) => !moved.has(name));
    if (byHand.length) plates.push(this.group("By hand", byHand.map((name) => this.hand(name, `${name}.manual`))));
    // What is nothing but noise has its switch.
    const disturbances = data.disturbances.filter((name) => !data.noises.some(({ input }) => input === name));
    if (disturbances.length) plates.push(this.group("Disturbances", disturbances.map((name) => this.hand(name, name))));
    this.place.replaceChildren(...plates);
    this.show();
  }

  /** Put the hand on a faceplate: on its setpoint, or on what else it has first. */
  focus(number: number): void {
    this.place.querySelectorAll(".faceplate")[number]?.querySelector<HTMLInputElement>("input:enabled")?.focus();
  }

  /** Press a button of the faceplate that has the focus, or of the first one. */
  press(words: string): void {
    const plate = document.activeElement?.closest(".faceplate") ?? this.place.querySelector(".faceplate");
    const buttons = [...(plate?.querySelectorAll<HTMLButtonElement>(".modes button") ?? [])];
    for (const button of buttons) if (button.textContent === words) button.click();
  }

  /** Show the rig as it stands, or only what moves. */
  show(isTold = true): void {
    for (const update of this.moving) update();
    if (isTold) for (const update of this.told) update();
  }

  private plate({ controls, moves }: LoopData): HTMLElement {
    const rows = controls.map((name) => this.controlled(name));
    return this.group([...controls, ...moves].join(" · "), [...rows, ...moves.map((name) => this.actuator(name))]);
  }

  private controlled(name: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const sensor = (): State => {
      const words = sensorWords(name, signal, (each) => this.rig.value(each)) || (this.rig.drifting(name) ? "drifts" : "");
      return { words, isFault: words !== "" };
    };
    const row = this.row(name, "PV", signal, () => this.rig.value(name), sensor);
    const aim = element("b", "aim");
    row.querySelector(".bar")!.append(aim);
    this.told.push(() => (aim.style.left = percent(share(signal, this.rig.value(`${name}.setpoint`)))));
    this.alarms(row, name, signal);
    row.append(this.knob(`Setpoint of ${name}`, "SP", signal, `${name}.setpoint`));
    return row;
  }

  private actuator(name: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const law = (): State => {
      const word = this.rig.value(`${name}.status`);
      const held = tripWords(name, this.rig.data.events, (each) => this.rig.value(each)) || this.interlock(name);
      return { words: held || statusWords(word), isFault: held !== "" || isFault(word) };
    };
    const row = this.row(name, "OP", signal, () => this.rig.value(name), law);
    this.limits(row, name, signal);
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
      this.told.push(() => button.setAttribute("aria-pressed", String(isManual() === (mode === MANUAL))));
      modes.append(button);
    }
    const manual = this.knob(`Manual value of ${name}`, "", signal, `${name}.manual`, isManual);
    row.append(modes, manual);
    return row;
  }

  private hand(name: string, input: string): HTMLElement {
    const signal = this.signals.get(name)!;
    const row = element("div", "signal");
    const head = element("p", "head");
    const state = element("span", "state", "");
    head.append(element("b", "", name), state);
    row.append(head, this.knob(name, "", signal, input));
    if (signal.words) row.title = signal.words;
    this.told.push(() => {
      const words = this.interlock(name);
      write(state, words);
      row.classList.toggle("fault", words !== "");
    });
    return row;
  }

  /** Return a signal with its bar, its number, what is abnormal about it, and its range. */
  private row(name: string, what: string, signal: ShownSignal, value: () => number, state: () => State): HTMLElement {
    const row = element("div", "signal");
    const head = element("p", "head");
    const [number, word] = [element("span", "number", ""), element("span", "state", "")];
    head.append(element("abbr", "", what), element("b", "", name), word, number);
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
    this.told.push(() => {
      const now = value();
      const part = share(signal, now);
      const end = part === undefined ? "" : part <= 0 ? "at its lowest" : part >= 1 ? "at its highest" : "";
      const found = state();
      write(number, shownText(signal, now));
      write(word, found.words || end);
      row.classList.toggle("abnormal", (found.words || end) !== "");
      row.classList.toggle("fault", found.isFault);
    });
    this.moving.push(() => (filled.style.width = percent(share(signal, value()))));
    return row;
  }

  /** Mark the alarms of a measurement that are there, and where they come. */
  private alarms(row: HTMLElement, name: string, signal: ShownSignal): void {
    const bar = row.querySelector(".bar")!;
    for (const alarm of this.rig.data.alarms.filter(({ measurement }) => measurement === name)) {
      const badge = new AlarmBadge(alarm);
      row.querySelector(".head .state")!.before(badge.place);
      this.told.push(() => badge.show(alarmState(alarm, (each) => this.rig.value(each))));
      if (alarm.limit === null) continue;
      const mark = element("s", "alarm-limit");
      mark.style.left = percent(share(signal, alarm.limit));
      bar.append(mark);
    }
  }

  /** Return by which alarms an input is held; "" where none holds it. */
  private interlock(name: string): string {
    const words = interlockWords(name, this.rig.data.alarms, (each) => this.rig.value(each));
    return words && `interlock: ${words}`;
  }

  /** Mark where the law stops what it moves, where that is before the end of its range. */
  private limits(row: HTMLElement, name: string, signal: ShownSignal): void {
    const limits = this.rig.data.controllers[this.rig.controller]!.limits[name];
    if (!limits) return;
    const bar = row.querySelector(".bar")!;
    const marks = [element("u", "limit"), element("u", "limit")];
    const words = element("span", "limits", "");
    bar.append(...marks);
    row.querySelector(".range")?.children[0]!.after(words);
    this.told.push(() => {
      const [low, high] = limits.map((setting) => this.rig.setting(this.rig.controller, setting)) as [number, number];
      const [from, to] = [share(signal, low) ?? 0, share(signal, high) ?? 1];
      marks[0]!.style.width = percent(from);
      marks[1]!.style.width = percent(1 - to);
      write(words, from > 0 || to < 1 ? `limits ${panelText(signal, low)} to ${shownText(signal, high)}` : "");
    });
  }

  private knob(label: string, what: string, signal: ShownSignal, input: string, isInHand = () => true): HTMLElement {
    const rest = this.rig.value(input);
    const low = signal.low ?? Math.min(0, 2 * rest);
    const high = signal.high ?? Math.max(2 * Math.abs(rest), low + 1 / signal.factor);
    const knob = new Knob(label, signal, [low, high], (value) => {
      this.rig.touch(input, value);
      this.changed();
    });
    if (what) knob.place.prepend(element("abbr", "", what));
    this.told.push(() => knob.show(this.rig.value(isInHand() ? input : input.replace(/\.manual$/, "")), isInHand()));
    return knob.place;
  }

  private group(title: string, rows: HTMLElement[]): HTMLElement {
    const plate = element("section", "faceplate");
    plate.setAttribute("aria-label", title);
    plate.append(element("h2", "", title), ...rows);
    return plate;
  }
}

interface State {
  words: string;
  isFault: boolean;
}

/** Return a share of a range as a length of its bar. */
function percent(part: number | undefined): string {
  return `${(100 * Math.min(1, Math.max(0, part ?? 0))).toFixed(2)}%`;
}

function write(place: HTMLElement, words: string): void {
  if (place.textContent !== words) place.textContent = words;
}

export function element<K extends keyof HTMLElementTagNameMap>(tag: K, kind: string, words?: string): HTMLElementTagNameMap[K] {
  const found = document.createElement(tag);
  if (kind) found.className = kind;
  if (words !== undefined) found.textContent = words;
  return found;
}
