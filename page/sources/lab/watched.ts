/** A task that is under way: which of its steps a run has reached, and what was measured between them. */

import type { TaskData } from "./lesson_data.ts";
import { measured } from "./measures.ts";
import { Reached, type Seen } from "./reached.ts";

/** A run as far as it has gone. */
export interface SeenRun extends Seen {
  /** Another one for every run. */
  readonly identity: object;
  /** The one that it went off from, if any. */
  readonly parent: object | undefined;
  /** Samples that it has. */
  readonly count: number;
}

export class Watched {
  readonly task: TaskData;
  private readonly period: number;
  private run: SeenRun;
  private reached: Reached;

  constructor(task: TaskData, run: SeenRun, period: number) {
    this.task = task;
    this.run = run;
    this.period = period;
    // The rig has gone through the first sample of the task.
    this.reached = new Reached(task.reach, Math.max(0, run.count - 1));
  }

  /** How many steps were reached. */
  get steps(): number {
    return this.reached.at.length;
  }

  /** The share of the next step that has held so far. */
  get share(): number {
    return this.reached.share;
  }

  /** Look at what a run has done since. */
  look(run: SeenRun): void {
    if (run.identity !== this.run.identity) {
      // A branch has the past of its run; any other run begins the task at its own beginning.
      this.reached = new Reached(this.task.reach, run.parent === this.run.identity ? this.reached.first : 0);
    } else if (run.count < this.reached.next) this.reached = new Reached(this.task.reach, Math.min(this.reached.first, run.count));
    this.run = run;
    this.reached.look(run.count, run);
  }

  /** Return what was measured for each figure [SI]; null for what is typed or not reached yet. */
  measured(): (number | null)[] {
    const ends = [this.reached.first, ...this.reached.at];
    return this.task.figures.map(({ measure }) => {
      if (!measure || measure.until >= ends.length) return null;
      const [first, last] = [ends[measure.after]!, ends[measure.until]!];
      // What the level was, not what a noisy sensor showed of it.
      const real = `${measure.signal}.true`;
      const output = Number.isNaN(this.run.value(real, last)) ? measure.signal : real;
      const samples = (name: string): Float64Array =>
        Float64Array.from({ length: last + 1 - first }, (_, place) => this.run.value(name, first + place));
      const setpoint = measure.target === "setpoint" && measure.kind !== "mean" ? samples(`${measure.signal}.setpoint`) : new Float64Array();
      return measured(measure, samples(output), setpoint, this.period);
    });
  }
}
