/** How many samples are due: time runs as fast as the reader wants, or as the machine can. */

/** A frame that took longer was none: the page slept [s]. */
const SLEPT = 0.5;

export class Pace {
  /** Times as fast as the plant; infinite for as fast as it goes. */
  speed = 1;
  private readonly period: number;
  /** Samples that are due, with parts of one. */
  private debt = 0;
  private isAwake = true;
  private before = 0;

  constructor(period: number) {
    this.period = period;
  }

  /** Forget what is due, as after a pause. */
  reset(): void {
    this.debt = 0;
  }

  /** Return how many samples are due after some time [s] has passed. */
  due(elapsed: number): number {
    if (this.speed === Infinity) return Infinity;
    this.before = this.debt;
    this.isAwake = elapsed < SLEPT;
    this.debt += (elapsed * this.speed) / this.period;
    return Math.floor(this.debt);
  }

  /** So many were computed. What a sleeping page missed stays due; what is too fast does not add up. */
  computed(samples: number): void {
    if (this.speed === Infinity) return;
    this.debt -= samples;
    if (this.isAwake) this.debt = Math.min(this.debt, Math.max(this.before, 1));
  }
}
