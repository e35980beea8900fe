/** What a stretch of a run was worth: `clepsydra.scores` of its samples, the last one included. */

import type { SetpointStep } from "../live/messages.ts";
import { settlingTime } from "../live/scores.ts";

/** Half the width of the band of settling, as a share of the setpoint step. */
export const BAND = 0.05;
/** Changes of a setpoint in one direction, no further apart than so many samples, are one step: a hand drags it. */
const DRAGGED = 20;

export interface ControlledScores {
  /** [signal unit × s] */
  iae: number;
  /** In the worst step [% of the step]; NaN where the setpoint stands. */
  overshoot: number;
  /** Of the slowest step [s]; infinite where it does not settle, NaN where the setpoint stands. */
  settling: number;
}

/**
 * Return the scores of a controlled variable.
 *
 * The output is the true one, without noise and faults of its sensor. `before` is the setpoint just
 * before the stretch, and `touched` are the places in it at which a hand did something: there a
 * step is no longer judged by what follows.
 */
export function controlledScores(
  setpoint: Float64Array, output: Float64Array, before: number, touched: number[], period: number,
): ControlledScores {
  const steps = setpointSteps(setpoint, before, touched);
  return {
    iae: absoluteError(setpoint, output) * period,
    overshoot: overshoot(steps, output),
    settling: settlingTime({ steps, band: BAND }, output, period),
  };
}

/** Return the sum of all moves [signal unit]. */
export function totalVariation(values: Float64Array): number {
  let sum = 0;
  for (let k = 1; k < values.length; ++k) sum += Math.abs(values[k]! - values[k - 1]!);
  return orInfinite(sum);
}

/** Return the steps of a setpoint in a stretch, each until the next touch. */
export function setpointSteps(setpoint: Float64Array, before: number, touched: number[]): SetpointStep[] {
  const steps: { first: number; last: number; start: number; target: number }[] = [];
  for (let k = 0; k < setpoint.length; ++k) {
    const [start, target] = [k ? setpoint[k - 1]! : before, setpoint[k]!];
    if (target === start) continue;
    const same = steps.at(-1);
    const isDragged = same && k - same.last <= DRAGGED && target > start === same.target > same.start;
    if (isDragged) Object.assign(same, { last: k, target });
    else steps.push({ first: k, last: k, start, target });
  }
  const found = steps.map(({ first, last, start, target }): SetpointStep => {
    // At its end the output still is what the step made of it.
    const end = touched.find((place) => place > last) ?? setpoint.length - 1;
    return [first, end + 1, start, target];
  });
  return found.filter(([first, stop]) => stop - first >= 2);
}

/** Return the sum of |e| over the samples, in which the setpoint is held and the output runs on a line. */
function absoluteError(setpoint: Float64Array, output: Float64Array): number {
  let sum = 0;
  for (let k = 1; k < output.length; ++k) {
    const [a, b] = [setpoint[k - 1]! - output[k - 1]!, setpoint[k - 1]! - output[k]!];
    const [p, q] = [Math.abs(a), Math.abs(b)];
    sum += (p + q) / 2 - (a > 0 !== b > 0 ? (p * q) / (p + q) : 0);
  }
  return orInfinite(sum);
}

function overshoot(steps: SetpointStep[], output: Float64Array): number {
  if (!steps.length) return NaN;
  let worst = 0;
  for (const [first, stop, start, target] of steps)
    for (let k = first; k < stop; ++k) worst = Math.max(worst, (output[k]! - target) / (target - start));
  return orInfinite(100 * worst);
}

const orInfinite = (value: number): number => (Number.isNaN(value) ? Infinity : value);
