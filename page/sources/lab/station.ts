/** One controller of a rig with the process that it moves, a sample at a time. */

import { Kernel } from "../live/kernel.ts";
import type { ControllerData, Start } from "./data.ts";

const MANUAL = 0;

export class Station {
  readonly data: ControllerData;
  readonly kernel: Kernel;
  /** Its inputs in automatic and as hands set them [SI]. */
  readonly given: Float64Array;
  private readonly inputs: Map<string, number>;
  private readonly outputs: Map<string, number>;
  private readonly modes: number[];
  private readonly manuals: number[];
  private readonly moved: number[];

  constructor(module: WebAssembly.Module, data: ControllerData, moved: string[]) {
    const { inputs, outputs, parameters, rings } = data;
    this.data = data;
    this.kernel = new Kernel(module, {
      state: data.starts.rest.state.length, parameters: parameters.length, inputs: inputs.length,
      outputs: outputs.length, rings, samples: 1,
    });
    this.given = Float64Array.from(inputs, ([, value]) => value);
    this.inputs = new Map(inputs.map(([name], place) => [name, place]));
    this.outputs = new Map(outputs.map((name, place) => [name, place]));
    this.modes = moved.map((name) => this.inputs.get(`${name}.mode`)!);
    this.manuals = moved.map((name) => this.inputs.get(`${name}.manual`)!);
    this.moved = moved.map((name) => this.outputs.get(name)!);
  }

  begin(start: Start): void {
    const { state, rings } = this.data.starts[start];
    this.kernel.begin(state, this.data.parameters);
    this.kernel.rings.set(rings);
    this.data.inputs.forEach(([, value], place) => (this.given[place] = value));
  }

  /** Set an input; one that this controller does not have is another's. */
  set(input: string, value: number): void {
    const place = this.inputs.get(input);
    if (place !== undefined) this.given[place] = value;
  }

  /** Return an input or, of the last sample, an output; undefined where there is none. */
  value(name: string): number | undefined {
    const output = this.outputs.get(name);
    if (output !== undefined) return this.kernel.record[output];
    const input = this.inputs.get(name);
    return input === undefined ? undefined : this.given[input];
  }

  /** Go through a sample, and return where the inputs of the process stand. */
  lead(): number[] {
    this.run(this.given);
    const { record } = this.kernel;
    return this.moved.map((place) => record[place]!);
  }

  /** Go through a sample in manual, with the inputs of the process where another one has them. */
  follow(moved: number[]): void {
    const inputs = this.given.slice();
    moved.forEach((value, place) => {
      inputs[this.modes[place]!] = MANUAL;
      inputs[this.manuals[place]!] = value;
    });
    this.run(inputs);
  }

  /** Take over the process as another one has moved it. */
  takeProcess(other: Station): void {
    this.kernel.state.set(other.kernel.state.subarray(0, this.data.moving));
    const theirs = other.processRings();
    this.processRings().forEach((ring, place) => ring.set(theirs[place]!));
  }

  /** Return what the delays of the process hold. */
  private processRings(): Float64Array[] {
    let end = 0;
    return this.data.rings.flatMap(({ length, isOfProcess }) => {
      end += length;
      return isOfProcess ? [this.kernel.rings.subarray(end - length, end)] : [];
    });
  }

  private run(inputs: Float64Array): void {
    this.kernel.inputs.set(inputs);
    this.kernel.done = 0;
    this.kernel.run(1);
  }
}
