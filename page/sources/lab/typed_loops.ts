/** Settings of PID loops as a reader types them, as values of the library's law: `designs/loops/multiloop.py`. */

import { Kernel } from "../live/kernel.ts";
import { lawOf } from "../live/linear_loop.ts";
import type { SampledSystem } from "../live/response.ts";
import { RestingLaw } from "../live/start.ts";
import type { Form, TypedLaw } from "./laws_data.ts";

/** Stands for an integral time that is infinite [s]. */
const NEVER = 1e9;

/**
 * One loop in its own form [SI].
 *
 * In the parallel form `integral` and `derivative` are gains, Ki and Kd, and `filter` is the time constant of
 * the derivative's filter; else they are the times Ti and Td, Ti infinite without integral action, and N = Td/Tf.
 */
export interface TypedLoop {
  gain: number;
  integral: number;
  derivative: number;
  filter: number;
  weight: number;
}

/** Return the parameters of a loop by what they are. `period` is the sampling period [s]. */
export function loopSettings({ gain, integral, derivative, filter, weight }: TypedLoop, form: Form, period: number): Record<string, number> {
  if (form === "parallel") {
    const [Ti, Td] = [gain / integral, derivative / gain];
    // Without a proportional part the integral is told at once.
    const tracking = gain === 0 ? (integral === 0 ? NEVER : period) : derivative ? Math.sqrt(Ti * Td) : Ti;
    return {
      proportional_gain: gain, integral_gain: integral, derivative_gain: derivative, filter_time: filter,
      setpoint_weight: weight, tracking_time: Math.min(Math.abs(tracking), NEVER),
    };
  }
  return {
    proportional_gain: gain, integral_time: Math.min(integral, NEVER), derivative_time: derivative, derivative_filter: filter,
    setpoint_weight: weight, tracking_time: Math.min(derivative ? Math.sqrt(integral * derivative) : integral, NEVER),
  };
}

/** Return the parameters of a law with these loops, one for each of its pairs; null is one that stays by hand. */
export function valuesOf(law: TypedLaw, before: number[], loops: (TypedLoop | null)[], period: number): number[] {
  const values = [...before];
  law.pairs.forEach(({ places }, pair) => {
    const loop = loops[pair];
    const own: Record<string, number> = loop ? loopSettings(loop, law.form, period) : { proportional_gain: 0 };
    for (const [part, value] of Object.entries(own)) values[places[part]!] = value;
  });
  return values;
}

/** A law of typed loops as a linear one, from its measurements to its outputs. */
export class LinearLoops {
  readonly #law: TypedLaw;
  readonly #rest: RestingLaw;
  readonly #slopes: Kernel | null;

  /** `values`: the parameters of the law with which the page was written. */
  constructor(law: TypedLaw, values: number[], modules: WebAssembly.Module[]) {
    const { slopes } = law;
    this.#law = law;
    this.#rest = new RestingLaw(law.law, modules[law.law.module]!, values);
    this.#slopes = slopes && new Kernel(modules[slopes.module]!, {
      state: 0, parameters: values.length + law.law.state.length, inputs: 0, outputs: slopes.entries.length, rings: [], samples: 1,
    });
  }

  at(values: number[]): SampledSystem | null {
    const { slopes } = this.#law;
    if (!slopes || !this.#slopes) return null;
    this.#slopes.begin([], [...values, ...this.#rest.rest(values)]);
    this.#slopes.run(1);
    const found = this.#slopes.record;
    return found.every(Number.isFinite) ? lawOf(slopes, found) : null;
  }
}
