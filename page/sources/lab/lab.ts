/** The page of a laboratory: the rig runs in it, and is seen and moved. */

import { unpacked } from "../live/bytes.ts";
import { Acknowledging } from "./acknowledging.ts";
import { AlarmList } from "./alarm_list.ts";
import { attach } from "./attached/begin.ts";
import { Bar } from "./bar.ts";
import type { Bench } from "./brought.ts";
import type { AttachedData, HeldData, LabData, PackedData, ShownSignal } from "./data.ts";
import { Drawing } from "./drawing.ts";
import { holdDropped } from "./dropped.ts";
import { Faceplates } from "./faceplates.ts";
import { Flows } from "./flows.ts";
import { Happened } from "./happened.ts";
import { Hands } from "./hands.ts";
import { browserStore } from "./kept_runs.ts";
import { levelled } from "./layout.ts";
import { Lesson } from "./lesson.ts";
import type { TaskData } from "./lesson_data.ts";
import { Laws } from "./laws.ts";
import { metPlant } from "./loop_margins.ts";
import { Pace } from "./pace.ts";
import { Pours } from "./pours.ts";
import { Rig } from "./rig.ts";
import { Runs } from "./runs.ts";
import { Scrubber } from "./scrubber.ts";
import { type Shortcut, Shortcuts } from "./shortcuts.ts";
import { SeenRunOfRig } from "./seen_run.ts";
import { setUp } from "./set_up.ts";
import { Trends } from "./trends.ts";
import { TripBanner } from "./trips.ts";

const FORM = 2;
/** What a frame may compute [ms]; between two looks at the clock so many samples. */
const [BUDGET, CHUNK] = [10, 20];
/** Trends are drawn and words written anew after so long [ms]; and runs are kept. */
const [SELDOM, RARELY] = [120, 10_000];

function at(id: string): HTMLElement {
  return document.getElementById(id)!;
}

async function begin(): Promise<void> {
  const found = JSON.parse(at("data").textContent!) as HeldData | AttachedData;
  if (found.form !== FORM) throw new Error("this page was written by another version");
  if ("attached" in found) return attach(found, at);
  const held = found;
  const { drawings, ...alike } = JSON.parse(new TextDecoder().decode(await unpacked(held.packed))) as PackedData;
  const data: LabData = { ...held, ...alike };
  document.querySelectorAll("figure[data-controller]:empty").forEach((figure, place) => (figure.innerHTML = drawings[place]!));
  const modules = await Promise.all(data.modules.map(async (text) => WebAssembly.compile(await unpacked(text))));
  const flows = data.flows ? new Flows(modules[data.flows.module]!, data.flows) : undefined;
  const plants = await Promise.all(data.laws.plants.map(metPlant));
  new Lab(data, new Rig(data, modules), { modules, plants }, flows);
}

class Lab {
  private readonly data: LabData;
  private readonly rig: Rig;
  private readonly signals: Map<string, ShownSignal>;
  private readonly pace: Pace;
  private readonly flows: Flows | undefined;
  private readonly happened: Happened;
  private readonly drawings: Drawing[];
  private readonly acknowledging: Acknowledging;
  /** None where the process has none. */
  private readonly alarms: AlarmList | undefined;
  private readonly pours: Pours;
  private readonly tripped: TripBanner;
  private readonly hands: Hands;
  private readonly faceplates: Faceplates;
  private readonly trends: Trends;
  private readonly scrubber: Scrubber;
  private readonly runs: Runs;
  private readonly bar: Bar;
  private readonly lesson: Lesson | undefined;
  private readonly laws: Laws;
  private isRunning = false;
  /** The controller whose drawing and faceplates are seen. */
  private shown = -1;
  private last = 0;
  private told = { at: 0, samples: 0, speed: 0 };

  constructor(data: LabData, rig: Rig, linear: Pick<Bench, "modules" | "plants">, flows: Flows | undefined) {
    this.data = data;
    this.rig = rig;
    this.flows = flows;
    this.signals = new Map(data.signals.map((each) => [each.name, each]));
    this.pace = new Pace(data.period);
    const figures = [...document.querySelectorAll<HTMLElement>("figure[data-controller]")];
    this.drawings = figures.map((figure) => new Drawing(figure, data, this.signals, flows));
    this.happened = new Happened(at("happened"), data, (name) => rig.title(name));
    rig.step();
    const shown = (): void => this.show();
    this.pours = new Pours(rig);
    this.acknowledging = new Acknowledging(rig);
    this.tripped = new TripBanner(at("tripped"), data);
    if (data.alarms.length) this.alarms = new AlarmList(at("alarms"), rig, this.acknowledging, shown);
    this.hands = new Hands(at("hands"), rig, this.signals, this.pours, shown);
    this.faceplates = new Faceplates(at("faceplates"), rig, this.signals, shown);
    const say = (words: string): void => this.say(words);
    this.runs = new Runs(at("runs"), rig, browserStore(), {
      say, pause: () => this.isRunning && this.run(false), moved: () => this.moved(), overlaid: () => this.trends.show(),
    });
    const source = () => ({ run: rig.run, sample: rig.sample, others: this.runs.overlaid });
    this.trends = new Trends(at("trends"), data, this.signals, source, say, (name) => rig.title(name));
    this.scrubber = new Scrubber(at("time"), rig, () => (this.isRunning && this.run(false), this.moved()));
    this.bar = new Bar(at("bar"), data.controllers.slice(0, data.laws.given.length).map((each) => each.title), {
      run: (isRunning) => this.run(isRunning),
      step: () => (this.step(), this.show(), this.seldom()),
      speed: (times) => ((this.pace.speed = times), this.pace.reset()),
      choose: (controller) => this.choose(controller),
      bring: () => this.laws.focus(),
      noise: (isOn) => rig.noise(isOn),
      begin: (start) => {
        rig.reset(start);
        this.laws.begun();
        rig.step();
        this.faceplates.build();
        this.show();
        this.seldom();
        this.say(start === "empty" ? "Starts with empty tanks." : "Starts at rest.");
      },
      goOn: () => {
        const { name } = rig.branch();
        this.moved();
        this.say(`Goes on from here as ${name}; the earlier run is kept.`);
      },
      save: () => this.runs.save(),
    });
    this.laws = new Laws(at("laws"), { data, laws: data.laws, signals: this.signals, ...linear }, rig, {
      step: () => (this.step(), this.seldom()),
      offered: (controller, title) => this.bar.offer(controller, title),
      chosen: (controller, title) => {
        this.bar.offer(controller, title);
        this.seen(controller, title);
      },
      say: (words) => this.say(words),
    });
    new Shortcuts(at("bar"), this.shortcuts());
    if (data.lesson)
      this.lesson = new Lesson(
        at("lesson"), data.lesson, data.period, (task) => this.setUp(task), () => new SeenRunOfRig(rig), say,
        `${data.process}, digest ${data.digest}, Clepsydra ${data.version}`,
      );
    this.showController();
    levelled(at("happened"), at("rig"), at("faceplates"));
    this.show();
    addEventListener("visibilitychange", () => document.hidden && this.runs.keep());
    setInterval(() => this.isRunning && this.runs.keep(), RARELY);
  }

  private shortcuts(): Shortcut[] {
    const { alarms, bar, faceplates } = this;
    return [
      { keys: [" "], told: "Space", words: "Run, or pause", action: () => this.run(!this.isRunning) },
      { keys: ["."], told: ".", words: "One sample", action: () => bar.press("step") },
      { keys: ["+", "="], told: "+", words: "Faster", action: () => bar.faster(1) },
      { keys: ["-"], told: "−", words: "Slower", action: () => bar.faster(-1) },
      {
        keys: [..."123456789"], told: "1 to 9", words: "To the first, second… faceplate",
        action: (key) => faceplates.focus(Number(key) - 1),
      },
      { keys: ["a"], told: "a", words: "The loop of this faceplate to automatic", action: () => faceplates.press("Auto") },
      { keys: ["m"], told: "m", words: "To manual", action: () => faceplates.press("Manual") },
      ...(alarms ? [{ keys: ["k"], told: "k", words: "Acknowledge all alarms", action: () => alarms.press() }] : []),
      { keys: ["n"], told: "n", words: "Noise on or off", action: () => bar.press("noise") },
      { keys: ["r"], told: "r", words: "Start at rest", action: () => bar.press("rest") },
      { keys: ["e"], told: "e", words: "Start empty", action: () => bar.press("empty") },
      { keys: ["h"], told: "h", words: "Start here: go on from this moment as another run", action: () => bar.press("here") },
      { keys: ["s"], told: "s", words: "Save the session", action: () => bar.press("save") },
    ];
  }

  private setUp(task: TaskData): void {
    setUp(this.rig, task, () => this.laws.begun());
    this.faceplates.build();
    this.moved();
    this.say(`The rig is set up for “${task.title}”.`);
  }

  private run(isRunning: boolean): void {
    this.isRunning = isRunning;
    this.pace.reset();
    this.last = this.told.at = performance.now();
    this.told.samples = this.rig.sample;
    this.told.speed = this.pace.speed === Infinity ? 0 : this.pace.speed;
    if (isRunning) requestAnimationFrame((now) => this.frame(now));
    else this.runs.keep();
    this.show();
    this.seldom();
  }

  private frame(now: number): void {
    if (!this.isRunning) return;
    const due = this.pace.due(Math.max(0, now - this.last) / 1000);
    this.last = now;
    let done = 0;
    for (const end = performance.now() + BUDGET; done < due && performance.now() < end; )
      for (const stop = Math.min(due, done + CHUNK); done < stop; done += 1) this.step();
    this.pace.computed(done);
    const isTold = now - this.told.at > SELDOM;
    if (isTold) {
      const passed = (now - this.told.at) / 1000;
      // Few samples say little of a speed that is kept.
      const measured = ((this.rig.sample - this.told.samples) * this.data.period) / passed;
      this.told = { at: now, samples: this.rig.sample, speed: done < due ? measured : this.pace.speed };
      this.seldom();
    }
    this.show(isTold);
    requestAnimationFrame((next) => this.frame(next));
  }

  private step(): void {
    this.pours.step();
    this.acknowledging.step();
    this.rig.step();
  }

  private choose(controller: number): void {
    this.laws.ready(controller);
    this.rig.choose(controller);
    this.seen(controller, this.laws.title(controller));
  }

  /** Show a controller that is now in control. */
  private seen(controller: number, title: string): void {
    this.showController();
    this.bar.chosen(controller, title);
    this.say(`${title} is now in control.`);
    this.show();
  }

  private showController(): void {
    const { controller } = this.rig;
    if (controller === this.shown) return;
    this.shown = controller;
    const { drawing } = this.data.controllers[controller]!;
    this.drawings.forEach((each, number) => each.turn(number === drawing, this.laws.title(controller)));
    this.faceplates.build();
  }

  /** Show the rig as it stands at another moment, or in another run. */
  private moved(): void {
    const { rig } = this;
    this.showController();
    const before = rig.run.touches.slice(0, rig.run.touchesBefore(rig.sample));
    this.bar.chosen(rig.controller, this.laws.title(rig.controller));
    this.bar.stand(before.reduce((isNoisy, touch) => ("noise" in touch ? touch.noise : isNoisy), false));
    this.show();
    this.seldom();
  }

  /** Show what takes its time. */
  private seldom(): void {
    this.trends.show(!this.isRunning);
    this.runs.show();
  }

  /** Show the rig as it stands, or only what of it moves. */
  private show(isTold = true): void {
    const value = (name: string): number => this.rig.value(name);
    this.flows?.update(this.rig);
    const { drawing } = this.data.controllers[this.rig.controller]!;
    this.drawings[drawing]!.show(value, (name) => this.rig.parameter(name), isTold);
    this.faceplates.show(isTold);
    if (!isTold) return;
    this.hands.show();
    this.tripped.show(this.rig.run, this.rig.sample, value);
    this.entitle();
    this.scrubber.show();
    this.laws.show();
    this.bar.show(this.isRunning, this.rig.sample * this.data.period, this.told.speed);
    this.happened.show(this.rig.run, this.rig.sample);
    this.alarms?.show();
    this.lesson?.show();
  }

  /** Let the title be that of the set-up that the rig is in. */
  private entitle(): void {
    const { data } = this;
    const title = (data.lesson ? undefined : this.hands.setup?.title) ?? data.setups[0]!.title;
    const heading = document.querySelector("h1")!;
    if (heading.textContent === title) return;
    heading.textContent = title;
    document.title = `${title} – laboratory`;
  }

  private say(words: string): void {
    at("said").textContent = words;
  }
}

const takeDropped = holdDropped();
begin().then(takeDropped, (error: unknown) => {
  at("said").textContent = `The laboratory cannot run here: ${error instanceof Error ? error.message : String(error)}.`;
});
