/** A controller of a rig with the process that it moves, wherever in a run it has got to. */

import { Kernel } from "../live/kernel.ts";
import { whiteNoise } from "../live/noise.ts";
import type { ControllerData, LabData, Takeover, Touch } from "./data.ts";
import type { Run, Snapshot } from "./run.ts";

const MANUAL = 0;
/** Of a delay. */
const RINGS = 3;
/** Samples after which a law has taken over what stands at its outputs, and the most that it may take. */
const [SHORTEST_SETTLING, LONGEST_SETTLING] = [4, 2000];
/** A state that moves by less than this share of its size stands still. */
const STILL = 1e-12;
/** Samples between two places from which a run can be gone through again. */
const BETWEEN_SNAPSHOTS = 1024;

export class Player {
  readonly data: ControllerData;
  readonly kernel: Kernel;
  /** The sample that comes next. */
  sample = 0;
  private readonly lab: LabData;
  /** Its place among the controllers. */
  private readonly place: number;
  private readonly inputs: Map<string, number>;
  private readonly outputs: Map<string, number>;
  private readonly parameters: Map<string, number>;
  /** For each input of the process the places of its mode, its manual value and what was asked for. */
  private readonly moved: [mode: number, manual: number, asked: number][];
  /** Its inputs as hands have set them [SI]. */
  private readonly given: Float64Array;
  private run: Run | undefined;
  private nextTouch = 0;
  private leading: string;
  private isNoisy = false;
  private readonly drifts = new Map<string, { rate: number; since: number }>();

  constructor(module: WebAssembly.Module, lab: LabData, place: number) {
    const data = lab.controllers[place]!;
    const { inputs, outputs, parameters, rings } = data;
    this.lab = lab;
    this.place = place;
    this.data = data;
    this.kernel = new Kernel(module, {
      state: data.starts.rest.state.length, parameters: parameters.length, inputs: inputs.length,
      outputs: outputs.length, rings, samples: 1,
    });
    this.given = new Float64Array(inputs.length);
    this.inputs = places(inputs.map(([name]) => name));
    this.outputs = places(outputs);
    this.parameters = places(parameters.map(([name]) => name));
    this.moved = lab.inputs.map((name) => [this.inputs.get(`${name}.mode`)!, this.inputs.get(`${name}.manual`)!, this.outputs.get(name)!]);
    this.leading = lab.controllers[0]!.name;
  }

  /** Whether it has the rig, in the sample that it has gone through last. */
  get leads(): boolean {
    return this.leading === this.data.name;
  }

  /** Return how many samples of a run it has not gone through. */
  behind(run: Run, sample: number): number {
    return this.run === run ? sample - this.sample : sample;
  }

  /** Go to where it stood before a sample of a run. */
  bring(run: Run, sample: number): void {
    if (this.run !== run || this.sample > sample) this.restore(run, sample);
    while (this.sample < sample) this.advance();
  }

  /** Go back to the last place before a sample of a run that is kept. */
  restore(run: Run, sample: number): void {
    const kept = run.snapshots[this.place]!.filter((each) => each.sample <= sample).at(-1);
    this.run = run;
    this.sample = kept?.sample ?? 0;
    const start = kept ?? this.data.starts[run.start];
    this.kernel.begin(start.state, this.data.parameters.map(([, value]) => value));
    this.kernel.rings.set(start.rings);
    this.data.inputs.forEach(([, value], place) => (this.given[place] = value));
    this.leading = this.lab.controllers[0]!.name;
    this.isNoisy = false;
    this.drifts.clear();
    this.nextTouch = 0;
    this.feel(this.sample - 1);
  }

  /** Go through a sample: with the rig, or in manual with the inputs where the one who has it asked for them. */
  advance(): void {
    const run = this.run!;
    const { kernel, sample } = this;
    if (sample % BETWEEN_SNAPSHOTS === 0) this.keep();
    this.feel(sample);
    const inputs = kernel.inputs;
    inputs.set(this.given);
    this.addNoise(inputs);
    if (!this.leads)
      this.moved.forEach(([mode, manual], place) => {
        inputs[mode] = MANUAL;
        inputs[manual] = run.history.value(this.lab.inputs[place]!, sample);
      });
    kernel.done = 0;
    kernel.run(1);
    this.sample += 1;
  }

  /** Take over the process as another one has moved it up to here. */
  takeOver(other: Player, start: Takeover): void {
    const { kernel, data } = this;
    if (other !== this) {
      kernel.state.set(other.kernel.state.subarray(0, data.moving));
      const theirs = other.ringsOf(true);
      this.ringsOf(true).forEach((ring, place) => ring.set(theirs[place]!));
    }
    this.feel(this.sample);
    if (start === "settled") this.settle();
    if (start === "zero") {
      kernel.state.set(data.cold.state, data.moving);
      let end = 0;
      for (const ring of this.ringsOf(false)) ring.set(data.cold.rings.slice(end, (end += ring.length)));
    }
    this.keep();
  }

  /** Let its law come to stand where everything is as it is: in manual, until nothing of it moves. */
  private settle(): void {
    const { kernel, sample } = this;
    const { moving } = this.data;
    const inputs = this.given.slice();
    this.addNoise(inputs);
    this.moved.forEach(([mode, manual], place) => {
      inputs[mode] = MANUAL;
      if (sample) inputs[manual] = this.run!.history.value(this.lab.inputs[place]!, sample - 1);
    });
    const process = kernel.state.slice(0, moving);
    const held = this.ringsOf(true).map((ring) => ring.slice());
    for (let passed = 0; passed < LONGEST_SETTLING; passed += 1) {
      const before = kernel.state.slice(moving);
      kernel.inputs.set(inputs);
      kernel.done = 0;
      kernel.run(1);
      kernel.state.set(process);
      this.ringsOf(true).forEach((ring, place) => ring.set(held[place]!));
      const now = kernel.state.subarray(moving);
      if (passed >= SHORTEST_SETTLING && before.every((value, place) => Math.abs(now[place]! - value) <= STILL * Math.max(1, Math.abs(now[place]!)))) return;
    }
  }

  /** Return an output of the last sample or an input [SI]; undefined where there is none. */
  value(name: string): number | undefined {
    const output = this.outputs.get(name);
    if (output !== undefined) return this.kernel.record[output];
    const input = this.inputs.get(name);
    return input === undefined ? undefined : this.given[input];
  }

  /** Return a parameter of the process, or of the law as its program calls it [SI]. */
  parameter(name: string): number | undefined {
    const place = this.parameters.get(name);
    return place === undefined ? undefined : this.kernel.parameters[place];
  }

  /** Return what comes out of the delays of the process: each has a ring of starts, of means and of ends. */
  delayed(): number[] {
    return this.ringsOf(true).flatMap((ring, place) => (place % RINGS ? [] : [ring[0]!]));
  }

  /** Return what a sensor drifts by in a second [SI/s]. */
  drifting(measurement: string): number {
    return this.drifts.get(measurement)?.rate ?? 0;
  }

  /** Keep where it stands, that it can come back. */
  private keep(): void {
    const kept = this.run!.snapshots[this.place]!;
    const now: Snapshot = { sample: this.sample, state: this.kernel.state.slice(), rings: this.kernel.rings.slice() };
    const last = kept.at(-1)?.sample ?? -1;
    if (last < now.sample) kept.push(now);
    else if (last === now.sample) kept[kept.length - 1] = now;
  }

  /** Feel the touches up to a sample. */
  private feel(sample: number): void {
    const { touches } = this.run!;
    for (; this.nextTouch < touches.length && touches[this.nextTouch]!.sample <= sample; ++this.nextTouch)
      this.feelOne(touches[this.nextTouch]!);
  }

  private feelOne(touch: Touch): void {
    if ("input" in touch) {
      const place = this.inputs.get(touch.input);
      if (place !== undefined) this.given[place] = touch.value;
    } else if ("parameters" in touch) this.set(touch.parameters);
    else if ("settings" in touch) {
      if (touch.of === this.data.name) this.set(touch.settings);
    } else if ("controller" in touch) this.leading = touch.controller;
    else if ("noise" in touch) this.isNoisy = touch.noise;
    else this.drifts.set(touch.drift, { rate: touch.rate, since: touch.sample });
  }

  private set(values: Record<string, number>): void {
    const { parameters } = this.kernel;
    for (const [name, value] of Object.entries(values)) {
      const place = this.parameters.get(name);
      if (place !== undefined) parameters[place] = value;
    }
  }

  private addNoise(inputs: Float64Array): void {
    if (this.isNoisy)
      for (const { input, stream, deviation } of this.lab.noises)
        inputs[this.inputs.get(input)!]! += whiteNoise({ seed: [this.lab.seed], stream, first: this.sample, count: 1, deviation })[0]!;
    for (const [measurement, { rate, since }] of this.drifts)
      inputs[this.inputs.get(`${measurement}.noise`)!]! += rate * ((this.sample - since) * this.lab.period);
  }

  /** Return what the delays of the process hold, or those of the law. */
  private ringsOf(process: boolean): Float64Array[] {
    const { rings } = this.kernel;
    let end = 0;
    return this.data.rings.flatMap(({ length, isOfProcess }) => {
      end += length;
      return isOfProcess === process ? [rings.subarray(end - length, end)] : [];
    });
  }
}

function places(names: string[]): Map<string, number> {
  return new Map(names.map((name, place) => [name, place]));
}
