/** A WebAssembly module of the engine with its memory: a program that runs whole or in parts. */

import type { RingOfState } from "./messages.ts";

const PAGE = 65536;
const NUMBER = 8;

type Run = (
  state: number, parameters: number, shared: number, individual: number, record: number, rings: number,
  groups: bigint, samples: bigint, every: bigint, turns: bigint,
) => void;

/** How many numbers of each kind a program has. */
export interface Sizes {
  state: number;
  parameters: number;
  inputs: number;
  outputs: number;
  rings: readonly RingOfState[];
  /** The longest run. */
  samples: number;
}

/** Return how many numbers rings hold together. */
function entries(rings: readonly RingOfState[]): number {
  return rings.reduce((sum, ring) => sum + ring.length, 0);
}

export class Kernel {
  readonly sizes: Sizes;
  /** Samples since `begin`. */
  done = 0;
  readonly #run: Run;
  readonly #memory: WebAssembly.Memory;
  /** Addresses. */
  readonly #state: number;
  readonly #parameters: number;
  readonly #inputs: number;
  readonly #record: number;
  readonly #rings: number;

  constructor(module: WebAssembly.Module, sizes: Sizes) {
    const memory = new WebAssembly.Memory({ initial: 1 });
    const { exports } = new WebAssembly.Instance(module, { env: { memory } });
    this.sizes = sizes;
    this.#memory = memory;
    this.#run = exports.clepsydra_kernel as Run;
    let end = (exports.heap as WebAssembly.Global<"i32">).value;
    const placed = (count: number): number => {
      const place = end;
      end += NUMBER * count;
      return place;
    };
    this.#state = placed(sizes.state);
    this.#parameters = placed(sizes.parameters);
    this.#inputs = placed(sizes.samples * sizes.inputs);
    this.#record = placed(sizes.samples * sizes.outputs);
    this.#rings = placed(entries(sizes.rings));
    const missing = Math.ceil(end / PAGE) - memory.buffer.byteLength / PAGE;
    if (missing > 0) memory.grow(missing);
  }

  // The kernel may take memory for itself, which leaves older views without a buffer: each of
  // these is good until the next run.
  get state(): Float64Array {
    return this.#view(this.#state, this.sizes.state);
  }

  get parameters(): Float64Array {
    return this.#view(this.#parameters, this.sizes.parameters);
  }

  /** Row by row [samples × inputs]. */
  get inputs(): Float64Array {
    return this.#view(this.#inputs, this.sizes.samples * this.sizes.inputs);
  }

  /** Row by row [samples × outputs]. */
  get record(): Float64Array {
    return this.#view(this.#record, this.sizes.samples * this.sizes.outputs);
  }

  /** What all rings hold, one after the other, the oldest of each first. */
  get rings(): Float64Array {
    return this.#view(this.#rings, entries(this.sizes.rings));
  }

  /** Go back to the first sample. */
  begin(state: ArrayLike<number>, parameters: ArrayLike<number>): void {
    this.state.set(state);
    this.parameters.set(parameters);
    for (const [ring, content] of this.#eachRing()) content.fill(ring.initial);
    this.done = 0;
  }

  /** Compute so many samples from where it stands. */
  run(samples: number): void {
    const { inputs, outputs } = this.sizes;
    const shared = this.#inputs + NUMBER * inputs * this.done;
    const record = this.#record + NUMBER * outputs * this.done;
    this.#run(
      this.#state, this.#parameters, shared, shared, record, this.#rings, 1n, BigInt(samples), 1n, 1n,
    );
    this.done += samples;
    // The oldest entry of each ring stands first, as the kernel takes it.
    for (const [{ length, turns }, content] of this.#eachRing()) {
      const turned = (turns * samples) % length;
      const before = content.slice(0, turned);
      content.copyWithin(0, turned);
      content.set(before, length - turned);
    }
  }

  *#eachRing(): Generator<[RingOfState, Float64Array]> {
    let place = this.#rings;
    for (const ring of this.sizes.rings) {
      yield [ring, this.#view(place, ring.length)];
      place += NUMBER * ring.length;
    }
  }

  #view(place: number, count: number): Float64Array {
    return new Float64Array(this.#memory.buffer, place, count);
  }
}
