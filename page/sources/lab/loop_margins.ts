/** What is told of the sampled loop of a law before it is switched on. */

import { unpackedNumbers } from "../live/bytes.ts";
import { eigenvalues } from "../live/eigenvalues.ts";
import { analysisOf, type Plant, plantOf } from "../live/linear_loop.ts";
import { marginsOf } from "../live/margins.ts";
import type { Matrix } from "../live/matrices.ts";
import type { ChannelMargins, SampledPlant } from "../live/messages.ts";
import type { SampledSystem } from "../live/response.ts";

/** A pole of less [1/s] is an integrator, whatever rounding has left of it. */
const INTEGRATOR = 1e-9;

/** The process as a law meets it. */
export interface MetPlant {
  names: SampledPlant;
  numbers: Plant;
  /** Ranges of what is controlled and of what is moved [SI]. */
  sizes: Float64Array;
  spans: Float64Array;
}

export async function metPlant(names: SampledPlant): Promise<MetPlant> {
  const found = await unpackedNumbers(names.packed);
  const numbers = plantOf(names, found);
  return { names, numbers, sizes: numbers.sizes, spans: found.slice(-names.manipulated.length) };
}

export interface LoopMargins {
  isStable: boolean;
  /** max|S| of the whole loop; infinite where it is unstable. */
  peak: number;
  /** Of each signal that the law acts on or moves; none where the loop is unstable. */
  margins: ChannelMargins[];
}

/** Return how robust the loop of a law is from measurements to outputs, of the signals that it joins. */
export function loopMargins({ names, numbers }: MetPlant, law: SampledSystem, joined: ReadonlySet<string>, period: number): LoopMargins {
  const { poles, stable, peak } = analysisOf(numbers, law);
  const margins = stable ? marginsOf(numbers, names, law, poles, period) : [];
  return { isStable: stable, peak, margins: margins.filter(({ name }) => joined.has(name)) };
}

/** A pole of a regulator in continuous time [1/s]. */
export interface Rate {
  real: number;
  imaginary: number;
  kind: "integrator" | "dies out" | "grows";
}

/** Return the poles of a regulator, the slowest first; of a sampled one as rates of continuous time. */
export function ratesOf(A: Matrix, period: number | null): Rate[] {
  const found = eigenvalues(A).map(({ real, imaginary }) => {
    if (period === null) return { real, imaginary };
    return { real: Math.log(Math.hypot(real, imaginary)) / period, imaginary: Math.atan2(imaginary, real) / period };
  });
  return found
    .map(({ real, imaginary }): Rate => {
      const isStill = Math.hypot(real, imaginary) < INTEGRATOR;
      return { real, imaginary, kind: isStill ? "integrator" : real < 0 ? "dies out" : "grows" };
    })
    .sort((one, other) => Math.hypot(one.real, one.imaginary) - Math.hypot(other.real, other.imaginary));
}
