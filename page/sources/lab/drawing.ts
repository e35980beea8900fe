/** The process drawing alive: levels, numbers, flows, and what is abnormal. */

import { alarmState, isWaiting, NORMAL, urgency } from "./alarm_states.ts";
import type { PlantData, ShownSignal } from "./data.ts";
import type { Flows } from "./flows.ts";
import { share, shownText } from "./quantities.ts";
import { numberText } from "../words";
import { actuatorWords, levelWords, sensorWords } from "./states.ts";
import { tripWords } from "./trips.ts";

type Value = (name: string) => number;
type Update = (value: Value, parameter: Value) => void;

/** Of a pipe in which nothing flows, what a flow adds that is much, and the widest [px]. */
const [THIN, PER_MUCH, WIDEST] = [1.2, 4, 9];
/** An arrow is as large as drawn up to this width of its pipe [px]. */
const ARROW = 4.5;
const MANUAL = 0;

export class Drawing {
  private readonly place: HTMLElement;
  private readonly title: Element;
  private readonly words: string;
  /** What moves, and what is read: words that change in each picture nobody reads. */
  private readonly moving: Update[] = [];
  private readonly told: Update[] = [];
  private readonly signals: Map<string, ShownSignal>;
  private readonly flows: Flows | undefined;

  constructor(place: HTMLElement, data: PlantData, signals: Map<string, ShownSignal>, flows: Flows | undefined) {
    this.place = place;
    this.title = place.querySelector("svg > title")!;
    this.words = this.title.textContent!;
    this.signals = signals;
    this.flows = flows;
    this.each("level", this.moving, (element, signal) => {
      const height = Number(element.dataset.height);
      return (value) => {
        const filled = Math.min(1, Math.max(0, share(signal, value(signal.name)) ?? 0));
        element.setAttribute("transform", `translate(0 ${(-height * filled).toFixed(2)})`);
      };
    });
    this.each("value", this.told, (element, signal) => {
      const before = element.dataset.before ?? "";
      return written(element, (value) => before + shownText(signal, value(signal.name)));
    });
    this.each("aim", this.moving, (element, signal) => pointed(element, signal));
    this.each("state", this.told, (element, signal) => this.state(element, signal, data));
    this.each("transmitter", this.told, (element, signal) => (value) => {
      element.classList.toggle("abnormal", sensorWords(signal.name, signal, value) !== "");
    });
    this.alarms(data);
    this.loops();
    if (flows) this.runs(flows);
    this.spilling(data);
    this.handled(data);
  }

  /** Be seen, or not, as what a controller does. */
  turn(isSeen: boolean, controller: string): void {
    this.place.hidden = !isSeen;
    if (isSeen) this.title.textContent = `${this.words}, controlled by ${controller}`;
  }

  /** Show signals of the rig and parameters of its process, or only what moves of them. */
  show(value: Value, parameter: Value, isTold: boolean): void {
    for (const update of this.moving) update(value, parameter);
    if (isTold) for (const update of this.told) update(value, parameter);
  }

  /** What is abnormal about a level or an actuator, and its percent where nothing is. */
  private state(element: SVGElement, signal: ShownSignal, data: PlantData): Update {
    const { name } = signal;
    const isLevel = data.levels.includes(name);
    const places = this.flows?.places(name) ?? [];
    const [zero, hundred] = [Number(element.dataset.zero), Number(element.dataset.hundred)];
    const percent = (value: number): string => {
      const part = (100 * (value - zero)) / (hundred - zero);
      return Number.isNaN(part) ? "" : `${part.toFixed(0)} %`;
    };
    return (value) => {
      const words = isLevel
        ? levelWords(share(signal, value(name)))
        : tripWords(name, data.events, value).split(":")[0] || (value(`${name}.interlock`) > 0 ? "interlock" : actuatorWords(name, signal, value, this.flows?.sum(places) ?? NaN));
      write(element, words || percent(value(name)));
      element.classList.toggle("abnormal", words !== "");
    };
  }

  /** The most urgent alarm of each measurement, at its transmitter. */
  private alarms(data: PlantData): void {
    for (const element of this.all("alarms")) {
      const own = data.alarms.filter(({ measurement }) => measurement === element.dataset.alarms);
      own.sort((one, other) => urgency(other) - urgency(one));
      const [letters, title] = [element.querySelector("text")!, element.querySelector("title")!];
      let before: unknown;
      this.told.push((value) => {
        const there = own.filter((alarm) => alarmState(alarm, value) !== NORMAL);
        const isOpen = (alarm: (typeof own)[number]): boolean => isWaiting(alarmState(alarm, value));
        const alarm = there.find(isOpen) ?? there[0];
        const now = alarm && `${alarm.name} ${isOpen(alarm)}`;
        if (now === before) return;
        before = now;
        element.setAttribute("class", alarm ? `mark shown alarm ${alarm.priority}${isOpen(alarm) ? " waiting" : ""}` : "mark");
        write(letters, alarm?.short ?? "");
        write(title, alarm?.words ?? "");
      });
    }
  }

  /** Setpoints, and loops that a hand has opened. */
  private loops(): void {
    for (const element of this.all("setpoint")) {
      const name = element.dataset.setpoint!;
      const signal = this.signals.get(name.replace(/\.setpoint$/, ""));
      const moves = element.dataset.moves?.split(" ") ?? [];
      const isManual = (value: Value): boolean => moves.some((each) => value(`${each}.mode`) === MANUAL);
      if (signal) this.told.push(written(element, (value) => (isManual(value) ? "MAN" : `SP ${shownText(signal, value(name))}`)));
    }
    for (const element of this.all("acts")) {
      const mode = `${element.dataset.acts!}.mode`;
      this.told.push((value) => element.classList.toggle("open", value(mode) === MANUAL));
    }
  }

  /** Pipes as wide as what flows in them, arrows where it flows to, and fittings that stand still. */
  private runs(flows: Flows): void {
    for (const element of this.all("pipe")) {
      const { pipe, from, to } = element.dataset;
      const places = flows.places(pipe!, from, to);
      if (!places.length) continue;
      const line = element.querySelector<SVGElement>("path:not(.arrow)")!;
      const title = element.querySelector("title")!;
      const name = title.textContent!;
      let before = "";
      this.moving.push(() => {
        const flow = flows.sum(places);
        const width = Math.min(WIDEST, THIN + (PER_MUCH * Math.abs(flow)) / flows.much).toFixed(1);
        const now = `${width} ${Math.sign(flow)}`;
        if (now !== before) {
          line.style.strokeWidth = `${width}px`;
          element.style.setProperty("--wider", String(Math.max(1, Number(width) / ARROW)));
          element.classList.toggle("stopped", flow === 0);
          element.classList.toggle("back", flow < 0);
          before = now;
        }
      });
      // Told to who points at it.
      element.addEventListener("pointerenter", () => {
        title.textContent = `${name}: ${shownText(flows.signal, flows.sum(places))}`;
      });
    }
    for (const element of this.all("of")) {
      const places = flows.places(element.dataset.of!);
      if (places.length) this.moving.push(() => element.classList.toggle("stopped", flows.sum(places) === 0));
    }
    for (const element of this.all("share")) {
      const [whole, part] = [undefined, element.dataset.to].map((to) => flows.places(element.dataset.share!, undefined, to));
      this.told.push(() => {
        const all = flows.sum(whole!);
        if (all > 0) write(element, `${numberText((100 * flows.sum(part!)) / all, 3)} %`);
      });
    }
    for (const element of this.all("flow")) {
      const places = flows.places(element.dataset.flow!);
      if (places.length) this.told.push(written(element, () => shownText(flows.signal, flows.sum(places))));
    }
  }

  /** What a tank spills while its total grows. */
  private spilling(data: PlantData): void {
    for (const element of this.all("spills")) {
      const spill = data.spills.find((each) => each.tank === element.dataset.spills);
      let before = Infinity;
      if (spill)
        this.moving.push((value) => {
          const now = value(spill.total);
          if (now === before) return;
          element.classList.toggle("shown", now > before);
          before = now;
        });
    }
  }

  /** What hands do to a tank: pour into it, drill it, plug its outlets. */
  private handled(data: PlantData): void {
    const mark = (kind: string, name: string, is: (value: Value, parameter: Value) => boolean): void => {
      for (const element of this.all(kind))
        if (element.dataset[kind] === name)
          this.moving.push((value, parameter) => element.classList.toggle("shown", is(value, parameter)));
    };
    for (const { tank, pour, extra_outlet, outlets } of data.tanks) {
      mark("pour", tank, (value) => value(pour) > 0);
      mark("extra", tank, (_, parameter) => parameter(extra_outlet) > 0);
      for (const [outlet, name] of Object.entries(outlets)) mark("plug", outlet, (_, parameter) => parameter(name) === 0);
    }
  }

  private all(kind: string): SVGElement[] {
    return [...this.place.querySelectorAll<SVGElement>(`[data-${kind}]`)];
  }

  private each(kind: string, updates: Update[], made: (element: SVGElement, signal: ShownSignal) => Update): void {
    for (const element of this.all(kind)) {
      const signal = this.signals.get(element.dataset[kind]!);
      if (signal) updates.push(made(element, signal));
    }
  }
}

/** Return what moves the pointer at the wall of a tank to a setpoint. */
function pointed(element: SVGElement, signal: ShownSignal): Update {
  const [empty, full, height] = [element.dataset.empty, element.dataset.full, element.dataset.height].map(Number) as [number, number, number];
  return (value) => {
    const part = Math.min(1, Math.max(0, (value(`${signal.name}.setpoint`) - empty) / (full - empty)));
    element.setAttribute("transform", `translate(0 ${(height * (1 - part)).toFixed(1)})`);
  };
}

/** Return what writes words into an element where they have changed. */
function written(element: Element, words: (value: Value) => string): Update {
  return (value) => write(element, words(value));
}

function write(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}
