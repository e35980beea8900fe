/** Every flow of the plant as it runs, computed by the plant's own equations when a picture asks. */

import { Kernel } from "../live/kernel.ts";
import type { FlowsData, ShownSignal } from "./data.ts";
import type { SeenRig } from "./seen_rig.ts";

/** Less than this share of what the plant calls much is none. */
const NOTHING = 1e-5;

export class Flows {
  /** A flow of the plant as a signal, to be written. */
  readonly signal: ShownSignal;
  /** What is much for the plant [m³/s]. */
  readonly much: number;
  private readonly data: FlowsData;
  private readonly kernel: Kernel;
  private rates: Float64Array;

  constructor(module: WebAssembly.Module, data: FlowsData) {
    this.data = data;
    this.much = data.much;
    this.signal = {
      name: "flow", words: "", unit: data.unit, factor: data.factor, low: 0, high: Math.max(data.much, 1e-12),
    };
    this.kernel = new Kernel(module, {
      state: 0, parameters: data.parameters.length, inputs: data.inputs.length, outputs: data.paths.length,
      rings: [], samples: 1,
    });
    this.rates = new Float64Array(data.paths.length);
  }

  /** Compute them as the rig stands. */
  update(rig: SeenRig): void {
    const { kernel, data } = this;
    const delayed = data.delays.length ? rig.delayed() : [];
    kernel.parameters.set(data.parameters.map((name) => rig.parameter(name)));
    kernel.inputs.set(data.inputs.map((name) => {
      const delay = data.delays.indexOf(name);
      if (delay >= 0) return delayed[delay]!;
      // What an input moves may stand elsewhere than it is asked to.
      const applied = rig.value(`${name}.applied`);
      return Number.isNaN(applied) ? rig.value(name) : applied;
    }));
    kernel.done = 0;
    kernel.run(1);
    this.rates = kernel.record.slice();
  }

  /**
   * Return the places of the flows that one element causes between two others [m³/s].
   *
   * An end that is the element itself stands for all of its flows.
   */
  places(element: string, source = element, destination = element): number[] {
    return this.data.paths.flatMap((path, place) => {
      const begins = source === element || path.source === source;
      const ends = destination === element || path.destination === destination;
      return path.element === element && begins && ends ? [place] : [];
    });
  }

  /** Return the sum of flows at places, 0 where it is next to nothing; NaN where there are none. */
  sum(places: number[]): number {
    if (!places.length) return NaN;
    const sum = places.reduce((total, place) => total + this.rates[place]!, 0);
    return Math.abs(sum) > NOTHING * this.much ? sum : 0;
  }
}
