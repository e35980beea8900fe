/**
 * Long curves with few points: of each so many samples the lowest and the highest, as they came.
 *
 * What was found once is kept, so that a curve of a million samples costs no more than what is new
 * of it; and what is left out stays left out while the curve scrolls, lest it tremble.
 */

/** What signals were, from sample `first` to before `count`. */
export interface Past {
  readonly first: number;
  readonly count: number;
  /** Return the values from a sample to before another; NaN where there are none. */
  values(name: string, first: number, stop: number): Float64Array;
}

/** Samples at which curves have points, and how many samples share two of these. */
export interface Grid {
  stride: number;
  samples: number[];
}

/** The points of whole buckets, two each, from which on. */
interface Kept {
  stride: number;
  first: number;
  points: number[];
}

/** What is so many times as long as what is seen, and no longer seen, is forgotten. */
const LONG = 4;

/** Return where curves between two samples have points: about `most` of them at most. */
export function gridOf(first: number, stop: number, most: number): Grid {
  let stride = 1;
  while ((stop - first) / stride > most / 2 && (stride > 1 || stop - first > most)) stride *= 2;
  const samples: number[] = [];
  if (stride === 1) for (let sample = first; sample < stop; ++sample) samples.push(sample);
  else
    for (let bucket = Math.floor(first / stride); bucket * stride < stop; ++bucket)
      samples.push(bucket * stride, bucket * stride + stride / 2);
  return { stride, samples };
}

export class Thinned {
  private readonly past: Past;
  private readonly kept = new Map<string, Kept>();

  constructor(past: Past) {
    this.past = past;
  }

  /** Return the values of a signal on a grid; NaN where there are none. */
  curve(name: string, { stride, samples }: Grid): number[] {
    if (!samples.length) return [];
    const first = samples[0]!;
    if (stride === 1) return [...this.past.values(name, first, samples.at(-1)! + 1)];
    const [begin, end] = [first / stride, samples.at(-2)! / stride + 1];
    const whole = Math.min(end, Math.floor(this.past.count / stride));
    const { points, first: start } = this.known(name, stride, begin, whole);
    const found = points.slice(2 * (begin - start), 2 * (Math.max(begin, whole) - start));
    // The last bucket still grows.
    for (let bucket = Math.max(begin, whole); bucket < end; ++bucket) found.push(...this.extremes(name, stride, bucket, bucket + 1));
    return found;
  }

  /** Return what is kept, with the points from `first` to before `stop`. */
  private known(name: string, stride: number, first: number, stop: number): Kept {
    let kept = this.kept.get(name);
    const end = kept ? kept.first + kept.points.length / 2 : 0;
    if (kept?.stride !== stride || first < kept.first || first > end || first - kept.first > LONG * (stop - first))
      kept = { stride, first, points: [] };
    this.kept.set(name, kept);
    const { points } = kept;
    for (const value of this.extremes(name, stride, kept.first + points.length / 2, stop)) points.push(value);
    return kept;
  }

  /** Return the lowest and the highest of each bucket, in the order in which they came. */
  private extremes(name: string, stride: number, first: number, stop: number): number[] {
    const found: number[] = [];
    const values = first < stop ? this.past.values(name, first * stride, stop * stride) : [];
    for (let start = 0; start < values.length; start += stride) {
      let [lowest, highest] = [start, start];
      let [low, high] = [Infinity, -Infinity];
      for (let place = start; place < start + stride; ++place) {
        const value = values[place]!;
        if (value < low) [low, lowest] = [value, place];
        if (value > high) [high, highest] = [value, place];
      }
      if (low > high) found.push(NaN, NaN);
      else found.push(...(lowest < highest ? [low, high] : [high, low]));
    }
    return found;
  }
}
