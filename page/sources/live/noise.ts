/**
 * White, normal noise that follows from a seed, a stream and the place of a sample alone.
 *
 * It is that of Python in every bit: engine/philox.py, engine/normal_quantile.py and
 * engine/white_noise.py say why each step is as it is, and have the references. No operation may
 * change place.
 */

import type { Noise } from "./messages.ts";

const ROUNDS = 10;
const MULTIPLIERS = [0xd2511f53, 0xcd9e8d57] as const;
const GROWTH = [0x9e3779b9, 0xbb67ae85] as const;

/** What the last word of a counter says it counts. */
const SAMPLES = 0;
const WORDS_OF_SEED = 1;

const PIECES = 8;
const DEGREE = 7;
/** 2⁻⁵⁴; powers are written out or doubled, since what ** rounds is left to the browser. */
const SMALLEST = 1 / 18014398509481984;
const FARTHEST = [8.285149113161363, -2017804525852002.2] as const;
const TERMS = 10;
/** Of the upper word of a share: of 49 bits, 32 are in the lower one. */
const SHIFT = 17;
const FIRST = (1023 - 54) * PIECES;
/** A piece in the table: its centre, then coefficients by rising powers. */
const WIDTH = 2 + DEGREE;

type Key = readonly [number, number];

/** Return the noise that a few numbers tell of. */
export function whiteNoise({ seed, stream, first, count, deviation }: Noise): Float64Array {
  const noise = new Float64Array(count);
  const words = new Uint32Array(4);
  const key = keyOf(seed);
  for (let sample = first; sample < first + count; ++sample) {
    const odd = sample % 2;
    if (odd === 0 || sample === first) {
      const block = (sample - odd) / 2;
      words.set([block, Math.floor(block / 4294967296), stream, SAMPLES]);
      philox(words, key);
    }
    noise[sample - first] = deviation * normalDeviate(words[2 * odd]!, words[2 * odd + 1]!);
  }
  return noise;
}

/** Return the key of a seed's words. */
function keyOf(seed: readonly number[]): Key {
  const words = new Uint32Array(4);
  let key: Key = [seed[0] ?? 0, seed[1] ?? 0];
  for (let place = 2; place < seed.length; place += 2) {
    words.set([seed[place]!, seed[place + 1] ?? 0, place / 2, WORDS_OF_SEED]);
    philox(words, key);
    key = [words[0]!, words[1]!];
  }
  return key;
}

/** Put random words in the place of a counter. */
function philox(words: Uint32Array, key: Key): void {
  let [first, second, third, fourth] = words as unknown as [number, number, number, number];
  let [left, right] = key;
  for (let round = 0; round < ROUNDS; ++round) {
    const one = upperHalf(first, MULTIPLIERS[0]);
    const other = upperHalf(third, MULTIPLIERS[1]);
    const lower = Math.imul(first, MULTIPLIERS[0]);
    first = other ^ second ^ left;
    second = Math.imul(third, MULTIPLIERS[1]);
    third = one ^ fourth ^ right;
    fourth = lower;
    left = (left + GROWTH[0]) | 0;
    right = (right + GROWTH[1]) | 0;
  }
  words[0] = first;
  words[1] = second;
  words[2] = third;
  words[3] = fourth;
}

/** Return the upper 32 of the 64 bits of a product of words. */
function upperHalf(a: number, b: number): number {
  const [low, high] = [a & 0xffff, a >>> 16];
  const [lower, upper] = [b & 0xffff, b >>> 16];
  const middle = Math.imul(high, lower) + (Math.imul(low, lower) >>> 16);
  const rest = Math.imul(low, upper) + (middle & 0xffff);
  return Math.imul(high, upper) + (middle >>> 16) + (rest >>> 16);
}

const share = new Float64Array(1);
const halves = new Uint32Array(share.buffer);
/** Which half has sign, exponent and the first bits. */
const UPPER = new Uint8Array(Uint32Array.of(1).buffer)[0] === 1 ? 1 : 0;
let table: Float64Array | undefined;

/** Return the normal deviate of two random words. */
function normalDeviate(upper: number, lower: number): number {
  table ??= quantileTable();
  share[0] = 2 * SMALLEST * ((upper & 0x7fffffff) * 2097152 + (lower >>> 11) + 0.5);
  const piece = WIDTH * ((halves[UPPER]! >>> SHIFT) - FIRST);
  const away = share[0]! - table[piece]!;
  let deviate = table[piece + WIDTH - 1]!;
  for (let place = piece + WIDTH - 2; place > piece; --place) {
    deviate = deviate * away + table[place]!;
  }
  return upper >>> 31 ? -deviate : deviate;
}

/** Return the table of the deviate that a share of the distribution lies beyond, by pieces. */
function quantileTable(): Float64Array {
  const pieces: number[] = [];
  let [deviate, slope]: [number, number] = [...FARTHEST];
  let series: number[] = [];
  let before = 0;
  for (let power = SMALLEST; power < 0.5; power *= 2) {
    for (let piece = 0; piece < PIECES; ++piece) {
      const centre = power * (1 + (2 * piece + 1) / (2 * PIECES));
      if (series.length) {
        let reached = series[DEGREE]!;
        for (let n = DEGREE - 1; n >= 0; --n) reached = reached * (centre - before) + series[n]!;
        const logarithm = ((reached - deviate) * (reached + deviate)) / 2;
        let growth = 1;
        for (let term = TERMS; term > 0; --term) growth = 1 + (growth * logarithm) / term;
        [deviate, slope] = [reached, slope * growth];
      }
      series = taylorSeries(deviate, slope);
      before = centre;
      pieces.push(centre, ...series);
    }
  }
  return Float64Array.from(pieces);
}

/** Return the Taylor coefficients of w by w″ = w (w′)². */
function taylorSeries(deviate: number, slope: number): number[] {
  const series = [deviate, slope];
  const slopes = [slope];
  const squares: number[] = [];
  for (let n = 0; n < DEGREE - 1; ++n) {
    let square = 0;
    let curvature = 0;
    for (let k = 0; k <= n; ++k) square += slopes[k]! * slopes[n - k]!;
    squares.push(square);
    for (let k = 0; k <= n; ++k) curvature += series[k]! * squares[n - k]!;
    slopes.push(curvature / (n + 1));
    series.push(slopes[n + 1]! / (n + 2));
  }
  return series;
}
