/** Where a law rests at the operating point with other values, as the engine's `RestingStates`. */

import { Kernel } from "./kernel.ts";
import type { LawProgram, LoopProgram } from "./messages.ts";

export class RestingLaw {
  readonly #law: LawProgram;
  readonly #kernel: Kernel;
  readonly #own: Float64Array;

  constructor(law: LawProgram, module: WebAssembly.Module, values: number[]) {
    this.#law = law;
    this.#kernel = new Kernel(module, {
      state: law.state.length,
      parameters: values.length,
      inputs: law.manual.length,
      outputs: 0,
      rings: [],
      samples: 1,
    });
    this.#own = this.#takenOver(values);
  }

  /** Return the state with which a loop begins where its law has these values. */
  begin(loop: LoopProgram, values: number[]): number[] {
    const state = [...loop.state];
    state.splice(loop.law, this.#law.state.length, ...this.rest(values));
    return state;
  }

  /** Return the state in which the law rests with these values. */
  rest(values: number[]): number[] {
    const taken = this.#takenOver(values);
    return this.#law.state.map((initial, place) => {
      const own = this.#own[place]!;
      const moved = taken[place]! - own;
      const noticed = Math.abs(moved) > this.#law.rounding * Math.max(1, Math.abs(own));
      return noticed && !this.#law.rings.includes(place) ? initial + moved : initial;
    });
  }

  /** Return the state after the law took over from manual, where it had come to rest. */
  #takenOver(values: number[]): Float64Array {
    const { state, manual, automatic, samples, most, rounding } = this.#law;
    const kernel = this.#kernel;
    kernel.begin(state, values);
    kernel.inputs.set(manual);
    for (let sample = 0; sample < most; ++sample) {
      const before = kernel.state.slice();
      this.#step();
      const moves = (now: number, place: number): boolean =>
        !(Math.abs(now - before[place]!) <= rounding * Math.max(1, Math.abs(now)));
      if (sample >= samples && !kernel.state.some(moves)) break;
    }
    kernel.inputs.set(automatic);
    this.#step();
    return kernel.state.slice();
  }

  #step(): void {
    this.#kernel.done = 0;
    this.#kernel.run(1);
  }
}
