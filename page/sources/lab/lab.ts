/** The page of a laboratory: the rig runs in it, and is seen and moved. */

import { unpacked } from "../live/bytes.ts";
import { Bar } from "./bar.ts";
import type { LabData, ShownSignal } from "./data.ts";
import { Drawing } from "./drawing.ts";
import { Faceplates } from "./faceplates.ts";
import { History } from "./history.ts";
import { Pace } from "./pace.ts";
import { shownText } from "./quantities.ts";
import { Rig } from "./rig.ts";
import { Trends } from "./trends.ts";

const FORM = 1;
/** What a frame may compute [ms]; between two looks at the clock so many samples. */
const [BUDGET, CHUNK] = [10, 20];
/** Trends are drawn anew, and the speed is told, after so long [ms]. */
const SELDOM = 120;

function at(id: string): HTMLElement {
  return document.getElementById(id)!;
}

async function begin(): Promise<void> {
  const data = JSON.parse(at("data").textContent!) as LabData;
  if (data.form !== FORM) throw new Error("this page was written by another version");
  const modules = await Promise.all(data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
  new Lab(data, new Rig(data, modules));
}

class Lab {
  private readonly data: LabData;
  private readonly rig: Rig;
  private readonly signals: Map<string, ShownSignal>;
  private readonly history: History;
  private readonly pace: Pace;
  private readonly drawings: Drawing[];
  private readonly faceplates: Faceplates;
  private readonly trends: Trends;
  private readonly bar: Bar;
  private isRunning = false;
  private last = 0;
  private told = { at: 0, samples: 0, speed: 0 };

  constructor(data: LabData, rig: Rig) {
    this.data = data;
    this.rig = rig;
    this.signals = new Map(data.signals.map((each) => [each.name, each]));
    const setpoints = data.controlled.map((name) => `${name}.setpoint`);
    this.history = new History([...data.controlled, ...setpoints, ...data.inputs]);
    this.pace = new Pace(data.period);
    const figures = [...document.querySelectorAll<HTMLElement>("figure[data-controller]")];
    this.drawings = figures.map((figure) => new Drawing(figure, this.signals));
    this.step();
    const shown = (): void => this.show();
    this.faceplates = new Faceplates(at("faceplates"), rig, this.signals, shown, (words) => this.say(words));
    this.trends = new Trends(at("trends"), rig, this.history, this.signals);
    this.bar = new Bar(at("bar"), data.controllers.map((each) => each.title), {
      run: (isRunning) => this.run(isRunning),
      step: () => (this.step(), this.show(), this.trends.show()),
      speed: (times) => ((this.pace.speed = times), this.pace.reset()),
      choose: (controller) => this.choose(controller),
      noise: (isOn) => rig.noise(isOn),
      begin: (start) => {
        rig.reset(start);
        this.history.clear();
        this.step();
        this.faceplates.build();
        this.show();
        this.trends.show();
        this.say(start === "empty" ? "Begins with empty tanks." : "Begins at rest.");
      },
      save: () => this.save(),
    });
    this.show();
  }

  private run(isRunning: boolean): void {
    this.isRunning = isRunning;
    this.pace.reset();
    this.last = this.told.at = performance.now();
    this.told.samples = this.rig.samples;
    this.told.speed = this.pace.speed === Infinity ? 0 : this.pace.speed;
    if (isRunning) requestAnimationFrame((now) => this.frame(now));
    this.show();
  }

  private frame(now: number): void {
    if (!this.isRunning) return;
    const due = this.pace.due(Math.max(0, now - this.last) / 1000);
    this.last = now;
    let done = 0;
    for (const end = performance.now() + BUDGET; done < due && performance.now() < end; )
      for (const stop = Math.min(due, done + CHUNK); done < stop; done += 1) this.step();
    this.pace.computed(done);
    if (now - this.told.at > SELDOM) {
      const passed = (now - this.told.at) / 1000;
      // Few samples say little of a speed that is kept.
      const measured = ((this.rig.samples - this.told.samples) * this.data.period) / passed;
      this.told = { at: now, samples: this.rig.samples, speed: done < due ? measured : this.pace.speed };
      this.trends.show();
    }
    this.show();
    requestAnimationFrame((next) => this.frame(next));
  }

  private step(): void {
    this.rig.step();
    this.history.add((name) => this.rig.value(name));
  }

  private choose(controller: number): void {
    this.rig.choose(controller);
    this.drawings.forEach(({ place }, number) => (place.hidden = number !== controller));
    this.faceplates.build();
    this.say(`${this.data.controllers[controller]!.title} has the rig from the next sample on.`);
    this.show();
  }

  private show(): void {
    const value = (name: string): number => this.rig.value(name);
    this.drawings[this.rig.controller]!.show(value);
    this.faceplates.show();
    this.bar.show(this.isRunning, this.rig.samples * this.data.period, this.told.speed);
    this.tellSpills();
  }

  private tellSpills(): void {
    const lines = this.rig.spills().map(({ tank, times, total }) => {
      const { factor, unit } = this.data.spills.find((each) => each.tank === tank)!;
      const amount = shownText({ name: tank, words: "", unit, factor, low: null, high: null }, total);
      return `${tank} spilt ${times === 1 ? "once" : `${times} times`}, ${amount} in all`;
    });
    const list = at("happened");
    if (list.textContent === lines.join("")) return;
    list.replaceChildren(...lines.map((line) => Object.assign(document.createElement("li"), { textContent: line })));
  }

  private say(words: string): void {
    at("said").textContent = words;
  }

  private save(): void {
    const session = this.rig.session();
    const file = new Blob([`${JSON.stringify(session, null, 1)}\n`], { type: "application/json" });
    const link = document.createElement("a");
    link.href = URL.createObjectURL(file);
    link.download = `${this.data.name}-session.json`;
    link.click();
    URL.revokeObjectURL(link.href);
    this.say(`Saved ${session.samples} samples; clepsydra replay ${link.download} runs them again.`);
  }
}

begin().catch((error: unknown) => {
  at("said").textContent = `The laboratory cannot run here: ${error instanceof Error ? error.message : String(error)}.`;
});
