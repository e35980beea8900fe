/** What hands did to a run and what happened in it, read in the order of time as the run goes on. */

import type { Touch } from "./data.ts";
import type { Run } from "./run.ts";
import type { Happening } from "./watches.ts";

export interface RunListener {
  /** Another run, or an earlier moment of this one: nothing was read yet. */
  begin(): void;
  touched(touch: Touch): void;
  happened(happening: Happening): void;
}

export class RunReader {
  private run: Run | undefined;
  private sample = 0;
  private touches = 0;
  private happened = 0;
  private readonly listener: RunListener;

  constructor(listener: RunListener) {
    this.listener = listener;
  }

  /** Tell what a run has before a sample, and was not told yet. */
  read(run: Run, sample: number): void {
    if (run !== this.run || sample < this.sample) this.begin(run);
    this.sample = sample;
    for (;;) {
      const touch = run.touches[this.touches];
      const happening = run.happened[this.happened];
      const next = Math.min(touch?.sample ?? Infinity, happening?.sample ?? Infinity);
      if (next >= sample) return;
      if (touch?.sample === next) {
        this.touches += 1;
        this.listener.touched(touch);
      } else {
        this.happened += 1;
        this.listener.happened(happening!);
      }
    }
  }

  private begin(run: Run): void {
    this.run = run;
    this.touches = this.happened = 0;
    this.listener.begin();
  }
}
