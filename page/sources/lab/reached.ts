/** Which steps of a task were reached, looked for sample by sample in a run. */

import type { ReachData } from "./lesson_data.ts";

/** What a run was at a sample. */
export interface Seen {
  /** A signal, a mode or a parameter [SI]; NaN for what there is not. */
  value(name: string, sample: number): number;
  /** The name of who had the rig. */
  controller(sample: number): string;
}

export class Reached {
  /** The sample at which each step that was reached was complete. */
  readonly at: number[] = [];
  /** The next sample that is looked at. */
  next: number;
  readonly first: number;
  private readonly steps: ReachData[];
  private inARow = 0;

  constructor(steps: ReachData[], first: number) {
    this.steps = steps;
    this.first = this.next = first;
  }

  get isDone(): boolean {
    return this.at.length === this.steps.length;
  }

  /** The share of the time that the step that is looked for has held so far. */
  get share(): number {
    return this.isDone ? 1 : this.inARow / this.steps[this.at.length]!.samples;
  }

  /** Look at all samples before this one. */
  look(stop: number, seen: Seen): void {
    for (; this.next < stop && !this.isDone; this.next += 1) {
      const step = this.steps[this.at.length]!;
      this.inARow = holds(step, this.next, seen) ? this.inARow + 1 : 0;
      if (this.inARow < step.samples) continue;
      this.at.push(this.next);
      this.inARow = 0;
    }
    this.next = Math.max(this.next, stop);
  }
}

function holds({ bands, controller }: ReachData, sample: number, seen: Seen): boolean {
  if (controller && seen.controller(sample) !== controller) return false;
  return Object.entries(bands).every(([name, [low, high]]) => {
    const value = seen.value(name, sample);
    return value >= (low ?? -Infinity) && value <= (high ?? Infinity);
  });
}
