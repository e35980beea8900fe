/** What a stretch of a run was worth, by the definitions of `clepsydra.scores`. */

import type { MeasureData } from "./lesson_data.ts";

/** A mean is over so much of a stretch, at its end. */
const LAST_SHARE = 0.25;

/**
 * Return a measure in SI of a signal's samples, where its setpoint stood at each, and the
 * sampling period [s]; infinite where a step never came so far, NaN where there was none.
 */
export function measured(
  { kind, target, band }: MeasureData, output: Float64Array, setpoint: Float64Array, period: number,
): number {
  const last = output.length - 1;
  if (last < 1 || !output.every(Number.isFinite)) return NaN;
  if (kind === "mean") {
    const late = output.subarray(output.length - Math.max(1, Math.round(LAST_SHARE * output.length)));
    return late.reduce((sum, value) => sum + value, 0) / late.length;
  }
  const goal = target === "end" ? output[last]! : setpoint[last]!;
  if (kind === "return_time") return period * lastEntry(output.map((value) => value - goal), band * Math.abs(goal));
  const step = goal - output[0]!;
  if (!step) return NaN;
  const share = output.map((value) => (value - output[0]!) / step);
  switch (kind) {
    case "overshoot":
      return Math.max(0, share.reduce((most, each) => Math.max(most, each), -Infinity) - 1);
    case "rise_time":
      return period * (firstCrossing(share, 0.9) - firstCrossing(share, 0.1));
    default:
      return period * lastEntry(share.map((each) => each - 1), band);
  }
}

/** Return at which sample, and part of one, a signal that rises comes to a height. */
function firstCrossing(signal: Float64Array, height: number): number {
  const place = signal.findIndex((each) => each >= height);
  if (place < 0) return Infinity;
  if (!place) return 0;
  const [before, after] = [signal[place - 1]!, signal[place]!];
  return place - 1 + (height - before) / (after - before);
}

/** Return after how many samples a distance is in a band around zero for good. */
function lastEntry(distances: Float64Array, band: number): number {
  let last = distances.length - 1;
  while (last >= 0 && !(Math.abs(distances[last]!) > band)) --last;
  if (last < 0) return 0;
  if (last === distances.length - 1) return Infinity;
  const [before, after] = [distances[last]!, distances[last + 1]!];
  return last + ((before > 0 ? band : -band) - before) / (after - before);
}
