/** What a run was worth: `clepsydra.scores` of what its loop added up and recorded. */

import type { FoldedScore, LiveScore, OutflowScore, SettlingScore } from "./messages.ts";
import type { Recorded } from "./recorded.ts";

/** Share of a response, at its end, over which the inflow is averaged. */
const LAST_SHARE = 0.1;
/** What of the largest inflow is no change of it, and what a turn of the outflow comes back by. */
const NO_CHANGE = 1e-6;
const TURN = 0.02;

/**
 * Return the scores of a run that is over; NaN for one that there is not.
 *
 * They are infinite where the run ended in a state of the process, or a score sees a value, that
 * is not finite.
 */
export function scoresOf(
  scores: LiveScore[], record: Recorded, state: Float64Array, ofProcess: number, period: number,
): number[] {
  const broken = !state.subarray(0, ofProcess).every(Number.isFinite);
  return scores.map((score) => (broken ? Infinity : scoreOf(score, record, state, period)));
}

function scoreOf(score: LiveScore, record: Recorded, state: Float64Array, period: number): number {
  switch (score.kind) {
    case "fold":
      return finished(score, state);
    case "settling":
      return settlingTime(score, record.column(score.column), period);
    default:
      return outflowScore(score, score.columns.map((column) => record.column(column)));
  }
}

function finished({ states, finish }: FoldedScore, state: Float64Array): number {
  const folds = states.map((place) => state[place]!);
  if (!folds.every(Number.isFinite)) return Infinity;
  const [first, second] = folds as [number, number];
  switch (finish) {
    case "ratio":
      return second > 0 ? first / second : NaN;
    case "deviation":
      return Math.sqrt(first / second / 2);
    default:
      return first;
  }
}

/** Return the longest time from a step until |z − 1| ≤ band for good, between samples by a line. */
export function settlingTime(
  { steps, band }: Pick<SettlingScore, "steps" | "band">, output: Float64Array, period: number,
): number {
  if (!output.every(Number.isFinite)) return Infinity;
  const times = steps.map(([first, stop, start, target]) => {
    const response = output.subarray(first, stop);
    const distances = response.map((value) => (value - start) / (target - start) - 1);
    return period * lastEntry(distances, band);
  });
  return times.length ? largest(times) : NaN;
}

/** Return after how many samples a distance enters a band around zero for good. */
function lastEntry(distances: Float64Array, band: number): number {
  let last = distances.length - 1;
  while (last >= 0 && !(Math.abs(distances[last]!) > band)) --last;
  if (last < 0) return 0;
  if (last === distances.length - 1) return Infinity;
  const [before, after] = [distances[last]!, distances[last + 1]!];
  const edge = before > 0 ? band : -band;
  return last + (edge - before) / (after - before);
}

/** Return what a tank makes of loads: of its outflow and inflow, or of its filling. */
function outflowScore({ kind, loads }: OutflowScore, columns: Float64Array[]): number {
  if (!columns.every((column) => column.every(Number.isFinite))) return Infinity;
  const [first, second] = columns as [Float64Array, Float64Array];
  if (kind === "volume_used") {
    const acting = loads.flatMap(([start, stop]) => [...first.subarray(start, stop)]);
    return 100 * (largest(acting) + largest(acting.map((value) => -value)));
  }
  const found = loads.map((load) => changes(second, first, load)).filter((each) => each.length);
  if (!found.length) return 0;
  if (kind === "outflow_overshoot") return 100 * (largest(found.map(largest)) - 1);
  return largest(found.map((each) => turns(each, TURN)));
}

/** Return the outflow since before a load, in units of what the inflow changes by; none for none. */
function changes(
  inflow: Float64Array, outflow: Float64Array, [start, stop]: [number, number],
): Float64Array {
  const before = Math.max(start - 1, 0);
  const late = inflow.subarray(stop - Math.max(1, rounded(LAST_SHARE * (stop - start))), stop);
  const change = late.reduce((sum, value) => sum + value, 0) / late.length - inflow[before]!;
  const size = Math.max(largest(inflow.map(Math.abs)), 1e-300);
  if (Math.abs(change) <= NO_CHANGE * size) return new Float64Array();
  return outflow.subarray(start, stop).map((value) => (value - outflow[before]!) / change);
}

/** Return how often a signal turns and comes back by more than a dead band. */
function turns(signal: Float64Array, band: number): number {
  let highest = signal[0]!;
  let lowest = highest;
  let direction = 0;
  let count = 0;
  for (const value of signal) {
    highest = Math.max(highest, value);
    lowest = Math.min(lowest, value);
    if (direction >= 0 && highest - value > band) {
      if (direction > 0) ++count;
      direction = -1;
      lowest = value;
    } else if (direction <= 0 && value - lowest > band) {
      if (direction < 0) ++count;
      direction = 1;
      highest = value;
    }
  }
  return count;
}

function largest(values: Iterable<number>): number {
  let found = -Infinity;
  for (const value of values) if (value > found) found = value;
  return found;
}

/** Round to the nearest whole number, halves to the even one. */
function rounded(value: number): number {
  const down = Math.floor(value);
  const over = value - down;
  return over > 0.5 || (over === 0.5 && down % 2) ? down + 1 : down;
}
