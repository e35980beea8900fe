/** A process under some controllers, of which one has it in its hands, and every touch of it. */

import { whiteNoise } from "../live/noise.ts";
import type { LabData, SessionFile, Start, Touch } from "./data.ts";
import { Station } from "./station.ts";

export class Rig {
  readonly data: LabData;
  start: Start = "rest";
  /** Samples since the start. */
  samples = 0;
  private readonly stations: Station[];
  /** Who has the rig, and who is to have it from the next sample on. */
  private leading = 0;
  private wanted = 0;
  private isNoisy = false;
  private wantsNoise = false;
  /** What hands have set since the last sample. */
  private readonly pending = new Map<string, number>();
  private touches: Touch[] = [];
  private readonly spilling = new Map<string, { before: number; times: number; isSpilling: boolean }>();

  constructor(data: LabData, modules: WebAssembly.Module[]) {
    this.data = data;
    this.stations = data.controllers.map((each) => new Station(modules[each.module]!, each, data.inputs));
    this.reset("rest");
  }

  /** The controller that has the rig, or will have it in the next sample. */
  get controller(): number {
    return this.wanted;
  }

  reset(start: Start): void {
    this.start = start;
    this.samples = 0;
    this.touches = [];
    this.pending.clear();
    this.leading = this.wanted;
    for (const station of this.stations) station.begin(start);
    for (const { tank } of this.data.spills) this.spilling.set(tank, { before: 0, times: 0, isSpilling: false });
    this.isNoisy = false;
    // Who had the rig keeps it: the first touch of a session says so.
    if (this.leading) this.touches.push({ sample: 0, controller: this.name(this.leading) });
  }

  /** Set an input of the program [SI] from the next sample on. */
  touch(input: string, value: number): void {
    if (!Number.isFinite(value)) throw new RangeError(`${input}: ${value}`);
    this.pending.set(input, value + 0); // no zero with a minus, which JSON would lose
  }

  /** Give the rig to another controller from the next sample on. */
  choose(controller: number): void {
    this.wanted = controller;
  }

  /** Let sensors be noisy, or not, from the next sample on. */
  noise(isOn: boolean): void {
    this.wantsNoise = isOn;
  }

  /** Return an input or an output by name [SI], as hands have it where they set it. */
  value(name: string): number {
    return this.pending.get(name) ?? this.stations[this.leading]!.value(name) ?? NaN;
  }

  step(): void {
    if (this.wanted !== this.leading) {
      this.stations[this.wanted]!.takeProcess(this.stations[this.leading]!);
      this.leading = this.wanted;
      this.touches.push({ sample: this.samples, controller: this.name(this.leading) });
    }
    for (const [input, value] of this.pending) {
      for (const station of this.stations) station.set(input, value);
      this.touches.push({ sample: this.samples, input, value });
    }
    this.pending.clear();
    this.makeNoise();
    const moved = this.stations[this.leading]!.lead();
    this.stations.forEach((station, place) => {
      if (place !== this.leading) station.follow(moved);
    });
    this.samples += 1;
    this.countSpills();
  }

  /** Return what each tank that spilt has spilt: how often, and how much in all [SI]. */
  spills(): { tank: string; times: number; total: number }[] {
    return this.data.spills.flatMap(({ tank }) => {
      const { times, before } = this.spilling.get(tank)!;
      return times ? [{ tank, times, total: before }] : [];
    });
  }

  /** Return what Python needs to run the same once more. */
  session(): SessionFile {
    const { form, version, digest, process, controllers, seed } = this.data;
    return {
      form, version, digest, process, controllers: controllers.map((each) => each.name),
      start: this.start, samples: this.samples, seed, touches: this.touches,
    };
  }

  /** Return the state of who has the rig, in the order of its program. */
  state(): Float64Array {
    return this.stations[this.leading]!.kernel.state.slice();
  }

  private name(controller: number): string {
    return this.data.controllers[controller]!.name;
  }

  private makeNoise(): void {
    const hasChanged = this.wantsNoise !== this.isNoisy;
    if (hasChanged) this.touches.push({ sample: this.samples, noise: this.wantsNoise });
    this.isNoisy = this.wantsNoise;
    if (!this.isNoisy && !hasChanged) return;
    for (const { input, stream, deviation } of this.data.noises) {
      const told = { seed: [this.data.seed], stream, first: this.samples, count: 1, deviation };
      const value = this.isNoisy ? whiteNoise(told)[0]! : 0;
      for (const station of this.stations) station.set(input, value);
    }
  }

  private countSpills(): void {
    for (const { tank, total } of this.data.spills) {
      const own = this.spilling.get(tank)!;
      const now = this.value(total);
      const isSpilling = now > own.before;
      if (isSpilling && !own.isSpilling) own.times += 1;
      own.isSpilling = isSpilling;
      own.before = now;
    }
  }
}
