/** What hands did and what happened, in words beside the samples in which that was. */

import type { Touch } from "./data.ts";
import type { TouchWords } from "./touch_words.ts";
import type { Happening } from "./watches.ts";

export interface Mark {
  sample: number;
  words: string;
  /** Whether it is something that should not be. */
  isAbnormal: boolean;
}

/** Of marks at one place, so many are told. */
const TOLD = 4;

/** One mark for each sample in which something was done or happened, in their order; there may be very many. */
export class Marks {
  private readonly told: TouchWords;
  private found: Mark[] = [];
  /** How many marks before each are abnormal. */
  private abnormal: number[] = [];
  private touches: readonly Touch[] = [];
  private happened: readonly Happening[] = [];
  /** How many of both are read. */
  private seen = { touches: 0, happened: 0 };

  constructor(told: TouchWords) {
    this.told = told;
  }

  /** Read what is new of a run. */
  read(touches: readonly Touch[], happened: readonly Happening[]): void {
    if (touches !== this.touches || happened !== this.happened) this.begin(touches, happened);
    const done = touches.slice(this.seen.touches).flatMap((touch) => this.told.of(touch).map((line) => ({ ...line, sample: touch.sample })));
    const all = [...done, ...happened.slice(this.seen.happened)].sort((one, other) => one.sample - other.sample);
    if (all.length && all[0]!.sample < (this.found.at(-1)?.sample ?? 0)) {
      // A run that was opened has all its touches before anything happens in it.
      this.begin(touches, happened);
      return this.read(touches, happened);
    }
    this.seen = { touches: touches.length, happened: happened.length };
    for (const { sample, words, isAbnormal } of all) this.add(sample, words, isAbnormal);
  }

  /** Return places from a sample to another that are so far apart, and whether something abnormal is there. */
  places(first: number, last: number, apart: number): Pick<Mark, "sample" | "isAbnormal">[] {
    const places: Pick<Mark, "sample" | "isAbnormal">[] = [];
    for (let at = this.from(first); at < this.found.length && this.found[at]!.sample <= last; ) {
      const { sample } = this.found[at]!;
      const next = Math.max(at + 1, this.from(sample + apart));
      places.push({ sample, isAbnormal: this.abnormalBefore(next) > this.abnormalBefore(at) });
      at = next;
    }
    return places;
  }

  /** Return the marks around a sample, the nearest first. */
  near(sample: number, within: number): Mark[] {
    const found = this.found.slice(this.from(sample - within), this.from(sample + within));
    return found.sort((one, other) => Math.abs(one.sample - sample) - Math.abs(other.sample - sample)).slice(0, TOLD);
  }

  private begin(touches: readonly Touch[], happened: readonly Happening[]): void {
    Object.assign(this, { touches, happened, found: [], abnormal: [], seen: { touches: 0, happened: 0 } });
  }

  private add(sample: number, words: string, isAbnormal: boolean): void {
    const last = this.found.at(-1);
    if (last?.sample === sample) {
      last.words += `, ${words}`;
      last.isAbnormal ||= isAbnormal;
      return;
    }
    this.abnormal.push(this.abnormalBefore(this.found.length));
    this.found.push({ sample, words, isAbnormal });
  }

  /** Return how many of the first so many marks are abnormal. */
  private abnormalBefore(count: number): number {
    return count ? this.abnormal[count - 1]! + Number(this.found[count - 1]!.isAbnormal) : 0;
  }

  /** Return the place of the first mark that is not before a sample. */
  private from(sample: number): number {
    let [low, high] = [0, this.found.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.found[middle]!.sample < sample) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
