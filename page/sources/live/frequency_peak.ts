/** The largest gain of a stable sampled system over frequency, as `linear/frequency_peak.py` finds it. */

import type { Complex } from "./complex.ts";
import { type Eigenvalue, eigenvalues } from "./eigenvalues.ts";
import { filled } from "./matrices.ts";
import { type Point, Response, type SampledSystem } from "./response.ts";

/** A maximum that can rise by less than this share is found. */
const RISE = 1e-9;
/** A maximum is looked at again at so many points between its neighbours, so often. */
const POINTS = 21;
const LOOKS = 16;
const PER_DECADE = 8;
/** Each pole turns the phase by half a turn; so many frequencies follow it. */
const PER_POLE = 8;
/** So far beyond the poles the curve is the one at zero or at infinity. */
const BEYOND = [1e2, 1e3];
/** Nearer to each other than this share of the least damping ratio, frequencies are one. */
const APART = 1e-3;

/**
 * Return the largest singular value over frequency of a system whose poles stand in the unit circle.
 *
 * Frequencies are those of s = (z − 1)/(z + 1).
 */
export function largestGain(system: SampledSystem, poles: Eigenvalue[]): number {
  const response = new Response(system);
  const gain = (frequency: number): number => largestSingularValue(response.at(onCircle(frequency)));
  const known = Math.max(gain(0), largestSingularValue(response.at({ real: -1, imaginary: 0 })));
  return highestPoint(gain, frequenciesOf(poles.map(image)), known);
}

/** Return the gain at angles of the unit circle, ωT; NaN beyond half the sampling frequency. */
export function gainsAt(system: SampledSystem, angles: number[]): number[] {
  const response = new Response(system);
  return angles.map((angle) => {
    if (angle > Math.PI) return NaN;
    return largestSingularValue(response.at({ real: Math.cos(angle), imaginary: Math.sin(angle) }));
  });
}

/** Return z = (1 + jω)/(1 − jω). */
function onCircle(frequency: number): Point {
  const square = frequency * frequency;
  return { real: (1 - square) / (1 + square), imaginary: (2 * frequency) / (1 + square) };
}

/** Return s = (z − 1)/(z + 1). */
function image({ real, imaginary }: Eigenvalue): Eigenvalue {
  const square = (real + 1) ** 2 + imaginary ** 2;
  return {
    real: ((real - 1) * (real + 1) + imaginary ** 2) / square,
    imaginary: (2 * imaginary) / square,
  };
}

/** Return the maximum of a curve; every one on the grid that can be the highest is looked at closer. */
function highestPoint(curve: (frequency: number) => number, grid: number[], known: number): number {
  let best = known;
  let rows = [grid.map(Math.log)];
  for (let look = 0; look < LOOKS && rows.length; ++look) {
    const values = rows.map((row) => row.map((place) => curve(Math.exp(place))));
    for (const row of values) for (const value of row) if (value > best) best = value;
    rows = rows.flatMap((row, place) => closer(row, values[place]!, best));
  }
  return best;
}

/** Return rows around the maxima of a row that can rise above the best. */
function closer(row: number[], values: number[], best: number): number[][] {
  const found: number[][] = [];
  const end = row.length - 1;
  values.forEach((top, place) => {
    const [low, high] = [Math.max(place - 1, 0), Math.min(place + 1, end)];
    if (!(top >= values[low]! && top >= values[high]!)) return;
    // A parabola through three points rises by an eighth of the drop to the lower side at most.
    const drop = top - Math.min(values[low]!, values[high]!);
    if (!(top + drop / 2 > best * (1 + RISE))) return;
    const step = (row[high]! - row[low]!) / (POINTS - 1);
    found.push(Array.from({ length: POINTS }, (_, each) => row[low]! + step * each));
  });
  return found;
}

/** Return frequencies that show every maximum of a rational response with these poles. */
function frequenciesOf(poles: Eigenvalue[]): number[] {
  const sizes = poles.map(({ real, imaginary }) => Math.hypot(real, imaginary));
  const [low, high] = [Math.min(...sizes) / 10, Math.max(...sizes) * 10];
  const steps = Math.ceil(PER_DECADE * Math.log10(high / low));
  const grid = BEYOND.flatMap((share) => [(low * 10) / share, (high / 10) * share]);
  for (let step = 0; step <= steps; ++step) grid.push(low * (high / low) ** (step / steps));
  poles.forEach(({ real, imaginary }, place) => {
    // Those of each pole stand between those of the others: equal poles share one fast turn.
    const shift = (place + 0.5) / poles.length;
    for (let turn = 0; turn < PER_POLE; ++turn) {
      const angle = Math.PI * ((turn + shift) / PER_POLE - 0.5);
      const around = imaginary + Math.abs(real) * Math.tan(angle);
      grid.push(Math.min(Math.max(around, low), high));
    }
  });
  const damping = Math.min(...poles.map(({ real }, place) => Math.abs(real) / sizes[place]!));
  const rising = grid.sort((one, other) => one - other);
  // Between two that agree but for rounding no slope is seen.
  return rising.filter((each, place) => each - (rising[place - 1] ?? 0) > APART * damping * each);
}

/** Return the largest singular value of a complex matrix. */
function largestSingularValue({ rows, columns, real, imaginary }: Complex): number {
  const wide = rows < columns;
  const size = wide ? rows : columns;
  /** Of GGᴴ or GᴴG, whichever is smaller. */
  const entry = (one: number, other: number): [number, number] => {
    let [share, across] = [0, 0];
    for (let inner = 0; inner < (wide ? columns : rows); ++inner) {
      const left = wide ? one * columns + inner : inner * columns + one;
      const right = wide ? other * columns + inner : inner * columns + other;
      share += real[left]! * real[right]! + imaginary[left]! * imaginary[right]!;
      across += imaginary[left]! * real[right]! - real[left]! * imaginary[right]!;
    }
    return [share, across];
  };
  if (size === 1) return Math.sqrt(entry(0, 0)[0]);
  if (size === 2) {
    const [[first], [last], [share, across]] = [entry(0, 0), entry(1, 1), entry(0, 1)];
    return Math.sqrt((first + last) / 2 + Math.hypot((first - last) / 2, share, across));
  }
  // [[re, −im], [im, re]] is symmetric and has each eigenvalue twice.
  const squares = filled(2 * size, 2 * size, (row, column) => {
    const [share, across] = entry(row % size, column % size);
    if (row < size === column < size) return share;
    return row < size ? -across : across;
  });
  return Math.sqrt(Math.max(...eigenvalues(squares).map((each) => each.real)));
}
