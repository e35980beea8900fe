/** A controller of the report with its loop, which runs the scenario with any values. */

import { columnNumbers } from "./columns.ts";
import { gainsAt } from "./frequency_peak.ts";
import { Kernel } from "./kernel.ts";
import { analysisOf, lawOf, type Plant, plantOf } from "./linear_loop.ts";
import { marginsOf } from "./margins.ts";
import type { AnalysedMessage, LiveController, LiveData, RanMessage } from "./messages.ts";
import { Recorded, shownOf } from "./recorded.ts";
import { scoresOf } from "./scores.ts";
import { RestingLaw } from "./start.ts";

/** What all loops of a report have in common. */
export interface Common {
  data: LiveData;
  /** Compiled, in the order of the data. */
  modules: WebAssembly.Module[];
  /** Row by row [samples × inputs]. */
  inputs: Float64Array;
  /** Of each event the samples of the run that are drawn. */
  events: number[][];
  /** At which S is told [rad/s]. */
  frequencies: number[];
}

export class LiveLoop {
  /** How many samples a part of a run has; whoever runs it finds what suits. */
  pace = 500;
  readonly #common: Common;
  readonly #controller: LiveController;
  readonly #kernel: Kernel;
  readonly #law: RestingLaw;
  readonly #slopes: Kernel | null;
  readonly #plant: Plant | null;

  /** `plant`: the numbers of the controller's sampled plant, if it has one. */
  constructor(common: Common, controller: LiveController, plant: Float64Array | null) {
    const { data, modules, inputs } = common;
    const { loop, law, slopes, values } = controller;
    this.#common = common;
    this.#controller = controller;
    this.#kernel = new Kernel(modules[loop.module]!, {
      state: loop.state.length,
      parameters: loop.parameters.length,
      inputs: data.inputs.length,
      outputs: loop.outputs,
      rings: loop.rings,
      samples: data.samples,
    });
    this.#kernel.inputs.set(inputs);
    this.#law = new RestingLaw(law, modules[law.module]!, values);
    this.#slopes =
      slopes &&
      new Kernel(modules[slopes.module]!, {
        state: 0, parameters: values.length + law.state.length, inputs: 0, outputs: slopes.entries.length, rings: [], samples: 1,
      });
    this.#plant = controller.plant && plant && plantOf(controller.plant, plant);
  }

  /** Samples that are still to come. */
  get left(): number {
    return this.#common.data.samples - this.#kernel.done;
  }

  /** Go back to the start, with other values of the law. */
  begin(values: number[]): void {
    const { loop } = this.#controller;
    const parameters = [...loop.parameters];
    parameters.splice(loop.first, values.length, ...values);
    this.#kernel.begin(this.#law.begin(loop, values), parameters);
  }

  /** Compute a part of the run. */
  advance(): void {
    this.#kernel.run(Math.min(this.pace, this.left));
  }

  /** Return what there is to show, of a run that is whole with its numbers. */
  found(): Pick<RanMessage, "whole" | "samples" | "curves" | "numbers" | "limits" | "spills" | "bands"> {
    const { loop, scores, bands } = this.#controller;
    const { data, events } = this.#common;
    const samples = this.#kernel.done;
    const record = new Recorded(this.#kernel.record, loop.outputs, samples);
    const whole = this.left === 0;
    const shown = { whole, samples, ...shownOf(record, this.#controller, events, data.period) };
    if (!whole) return { ...shown, numbers: data.columns.map(() => NaN), bands: [] };
    const found = scoresOf(scores, record, this.#kernel.state, loop.law, data.period);
    return {
      ...shown,
      numbers: columnNumbers(data.columns, found),
      bands: bands.map(({ name, score }) => ({ name, seconds: found[score]! })),
    };
  }

  /** Return how robust the loop is with these values; null where it has no linear model. */
  analysed(values: number[]): Pick<AnalysedMessage, "peak" | "stable" | "sensitivity" | "margins"> | null {
    const { slopes, plant } = this.#controller;
    if (!slopes || !plant || !this.#slopes || !this.#plant) return null;
    this.#slopes.begin([], [...values, ...this.#law.rest(values)]);
    this.#slopes.run(1);
    const found = this.#slopes.record;
    const { data: { period }, frequencies } = this.#common;
    const none = frequencies.map(() => NaN);
    if (!found.every(Number.isFinite)) return { peak: NaN, stable: false, sensitivity: none, margins: [] };
    const law = lawOf(slopes, found);
    const { poles, stable, peak, sensitivity } = analysisOf(this.#plant, law);
    return {
      peak,
      stable,
      sensitivity: sensitivity ? gainsAt(sensitivity, frequencies.map((each) => each * period)) : none,
      // What an unstable loop has of them is no room that it has.
      margins: stable ? marginsOf(this.#plant, plant, law, poles, period) : [],
    };
  }
}
