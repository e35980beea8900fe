/** A process under some controllers, of which one has it in its hands, and every run of it. */

import type { Hand, LabData, SessionFile, Start, Takeover } from "./data.ts";
import { History } from "./history.ts";
import { Player } from "./player.ts";
import { Run } from "./run.ts";
import { Watches } from "./watches.ts";

export class Rig {
  readonly data: LabData;
  /** Every run that is kept; `run` is the one that is shown. */
  runs: Run[] = [];
  run!: Run;
  /** Samples that it has gone through: where it stands in the run. */
  sample = 0;
  private readonly players: Player[];
  private readonly names: string[];
  /** Who has the rig. */
  private leading = 0;
  /** What hands have done since the last sample, each thing once. */
  private readonly waiting = new Map<string, Hand>();
  /** What controllers are called from the next sample on. */
  private called: Record<string, string> = {};
  private wantsNoise = false;
  private counted = 0;
  private watches: Watches;
  /** Whose turn it is to keep up. */
  private turn = 0;

  constructor(data: LabData, modules: WebAssembly.Module[]) {
    this.data = data;
    this.watches = new Watches(data);
    this.players = data.controllers.map((each, place) => new Player(modules[each.module]!, data, place));
    const { measurements, controlled, inputs, disturbances, tanks, spills } = data;
    this.names = [
      ...measurements, ...controlled.flatMap((name) => [`${name}.setpoint`, `${name}.true`]), ...inputs, ...disturbances,
      ...tanks.map(({ pour }) => pour), ...spills.map(({ total }) => total),
    ];
    this.reset("rest");
  }

  /** The controller that has the rig, or will have it in the next sample. */
  get controller(): number {
    const touch = this.waiting.get("controller");
    return touch && "controller" in touch ? this.placeOf(touch.controller) : this.leading;
  }

  /** How many samples of the run are still to be computed. */
  get due(): number {
    return this.run.samples - this.run.history.count;
  }

  /** Begin a new run; who has the rig keeps it. */
  reset(start: Start): void {
    const { controller } = this;
    this.begin(new Run(this.newName(), start, new History(this.names), this.players.length));
    if (controller) this.choose(controller);
    if (this.wantsNoise) this.noise(true);
  }

  /** Set an input of the program [SI] from the next sample on. */
  touch(input: string, value: number): void {
    this.wait(`input ${input}`, { input, value: finite(input, value) });
  }

  /** Give parameters of the process other values [SI]. */
  parameters(values: Record<string, number>): void {
    const before = this.waiting.get("parameters");
    const known = before && "parameters" in before ? before.parameters : {};
    this.wait("parameters", { parameters: { ...known, ...eachFinite(values) } });
  }

  /** Give parameters of the law of a controller other values, as its program calls them [SI]. */
  settings(controller: number, values: Record<string, number>): void {
    const of = this.nameOf(controller);
    const before = this.waiting.get(`settings ${of}`);
    const known = before && "settings" in before ? before.settings : {};
    this.wait(`settings ${of}`, { settings: { ...known, ...eachFinite(values) }, of });
  }

  /** Give the rig to another controller: without a bump, or with its state at zero. */
  choose(controller: number, start: Takeover = "bumpless"): void {
    if (controller === this.leading && start === "bumpless") this.waiting.delete("controller");
    else this.wait("controller", { controller: this.nameOf(controller), start });
  }

  /** Call a controller by what the reader has brought for it, from the next sample on. */
  call(controller: number, title: string): void {
    this.called[this.nameOf(controller)] = title;
  }

  /** Return what a controller is called in a run. */
  title(name: string, run = this.run): string {
    const own = this.data.controllers[this.placeOf(name)]!.title;
    return (run === this.run ? this.called[name] : undefined) ?? run.titles[name] ?? own;
  }

  /** Let sensors and noisy disturbances be noisy, or not. */
  noise(isOn: boolean): void {
    this.wantsNoise = isOn;
    this.wait("noise", { noise: isOn });
  }

  /** Let a sensor drift [SI/s]; 0 ends it. */
  drift(measurement: string, rate: number): void {
    this.wait(`drift ${measurement}`, { drift: measurement, rate: finite(measurement, rate) });
  }

  /** Go through a sample. From a moment of the past it goes on as another run. */
  step(): void {
    if (this.sample < this.run.samples) this.branch();
    for (const touch of this.waiting.values()) this.run.touches.push({ sample: this.sample, ...touch });
    Object.assign(this.run.titles, this.called);
    this.forget();
    this.next();
  }

  /** Go on with a run of its own that has the same past. */
  branch(): Run {
    const run = this.run.fork(this.newName(), this.sample);
    this.runs.push(run);
    this.run = run;
    this.bringLeading();
    return run;
  }

  /** Stand where the run stood after so many samples, at least one. */
  goTo(sample: number): void {
    this.forget();
    this.sample = Math.min(Math.max(1, sample, this.run.history.first + 1), this.run.history.count);
    this.bringLeading();
  }

  /** Show another run, at its end. */
  open(run: Run): void {
    this.forget();
    this.run = run;
    this.sample = run.history.count;
    if (this.sample) this.bringLeading();
    else this.restart();
  }

  /** Take a run that was saved; `catchUp` computes it. */
  load(session: SessionFile, name: string): Run {
    const run = new Run(name, session.start, new History(this.names), this.players.length, [...session.touches]);
    run.samples = session.samples;
    Object.assign(run.titles, session.titles);
    this.begin(run);
    return run;
  }

  /** Compute some of what is still to come of the run. */
  catchUp(most: number): void {
    for (let left = Math.min(most, this.due); left > 0; --left) this.next();
  }

  /** Return an input or an output by name [SI], as hands have it where they set it. */
  value(name: string): number {
    return this.asked(name) ?? this.players[this.leading]!.value(name) ?? NaN;
  }

  /** Return what a hand has set an input to since the last sample [SI]; undefined where none has. */
  asked(input: string): number | undefined {
    const touch = this.waiting.get(`input ${input}`);
    return touch && "input" in touch ? touch.value : undefined;
  }

  /** Return a parameter of the process [SI]. */
  parameter(name: string): number {
    const touch = this.waiting.get("parameters");
    const waiting = touch && "parameters" in touch ? touch.parameters[name] : undefined;
    return waiting ?? this.players[this.leading]!.parameter(name) ?? NaN;
  }

  /** Return what comes out of the delays of the process, as it stands [SI]. */
  delayed(): number[] {
    return this.players[this.leading]!.delayed();
  }

  /** Return what a sensor drifts by in a second [SI/s]. */
  drifting(measurement: string): number {
    const touch = this.waiting.get(`drift ${measurement}`);
    if (touch && "rate" in touch) return touch.rate;
    return this.players[this.leading]!.drifting(measurement);
  }

  /** Return a parameter of the law of a controller, as its program calls it [SI]. */
  setting(controller: number, name: string): number {
    const of = this.nameOf(controller);
    const waiting = this.waiting.get(`settings ${of}`);
    if (controller === this.leading && !waiting) return this.players[controller]!.parameter(name) ?? NaN;
    const touches = [...this.run.touches.slice(0, this.run.touchesBefore(this.sample)), ...(waiting ? [waiting] : [])];
    const last = touches.filter((each) => "settings" in each && each.of === of && name in each.settings).at(-1);
    if (last && "settings" in last) return last.settings[name]!;
    return this.data.controllers[controller]!.parameters.find(([each]) => each === name)?.[1] ?? NaN;
  }

  /** Return what each tank that spilt has spilt: how often, and how much in all [SI]. */
  spills(): { tank: string; times: number; total: number }[] {
    return this.data.spills.flatMap(({ tank, total }) => {
      const spilt = this.run.happened.filter(({ kind, of, sample }) => kind === "spill" && of === tank && sample < this.sample);
      const times = spilt.length;
      return times ? [{ tank, times, total: this.value(total) }] : [];
    });
  }

  /** Return what Python needs to do a run once more. */
  session(run = this.run): SessionFile {
    const { form, version, digest, process, seed, laws } = this.data;
    const controllers = this.data.controllers.slice(0, laws.given.length);
    return {
      form, version, digest, process, controllers: controllers.map((each) => each.name),
      start: run.start, samples: run.samples, seed, touches: run.touches,
      ...(Object.keys(run.titles).length ? { titles: run.titles } : {}),
    };
  }

  /** Return the state of who has the rig, in the order of its program. */
  state(): Float64Array {
    return this.players[this.leading]!.kernel.state.slice();
  }

  private wait(what: string, hand: Hand): void {
    this.waiting.set(what, hand);
  }

  private forget(): void {
    this.waiting.clear();
    this.called = {};
  }

  private begin(run: Run): void {
    this.forget();
    this.runs.push(run);
    this.run = run;
    this.restart();
  }

  private restart(): void {
    this.sample = 0;
    this.leading = 0;
    this.players[0]!.restore(this.run, 0);
    this.watches = new Watches(this.data);
  }

  /** Go through a sample with the touches that the run has for it. */
  private next(): void {
    const { run, sample } = this;
    for (let place = run.touchesBefore(sample); run.touches[place]?.sample === sample; ++place) {
      const touch = run.touches[place]!;
      if ("controller" in touch) this.takeOver(this.placeOf(touch.controller), touch.start);
    }
    const player = this.players[this.leading]!;
    player.advance();
    run.history.add((column) => player.value(this.names[column]!)!);
    this.sample += 1;
    run.samples = Math.max(run.samples, this.sample);
    run.happened.push(...this.watches.look((name) => player.value(name) ?? NaN, sample));
    this.keepUp();
  }

  private takeOver(controller: number, start: Takeover): void {
    const before = this.players[this.leading]!;
    const player = this.players[controller]!;
    player.bring(this.run, this.sample);
    player.takeOver(before, start);
    this.leading = controller;
  }

  /** Let who had the rig in the last sample stand where it stood after that. */
  private bringLeading(): void {
    let leading = 0;
    for (const touch of this.run.touches.slice(0, this.run.touchesBefore(this.sample)))
      if ("controller" in touch) leading = this.placeOf(touch.controller);
    this.leading = leading;
    const player = this.players[leading]!;
    // The sample before is gone through once more, for what it records.
    player.restore(this.run, this.sample - 1);
    player.bring(this.run, this.sample);
    // What is so already does not begin here.
    this.watches = new Watches(this.data);
    this.watches.look((name) => player.value(name) ?? NaN, this.sample);
  }

  /** Let those that follow get no farther behind than the history reaches back. */
  private keepUp(): void {
    const { history } = this.run;
    this.turn = (this.turn + 1) % this.players.length;
    const player = this.players[this.turn]!;
    const behind = player.behind(this.run, this.sample);
    if (behind > history.capacity / 2) player.bring(this.run, this.sample - behind + 2 * this.players.length);
  }

  private newName(): string {
    this.counted += 1;
    return `Run ${this.counted}`;
  }

  private nameOf(controller: number): string {
    return this.data.controllers[controller]!.name;
  }

  private placeOf(name: string): number {
    return this.data.controllers.findIndex((each) => each.name === name);
  }
}

/** Return a number that JSON does not lose: finite, and no zero with a minus. */
function finite(name: string, value: number): number {
  if (!Number.isFinite(value)) throw new RangeError(`${name}: ${value}`);
  return value + 0;
}

function eachFinite(values: Record<string, number>): Record<string, number> {
  return Object.fromEntries(Object.entries(values).map(([name, value]) => [name, finite(name, value)]));
}
