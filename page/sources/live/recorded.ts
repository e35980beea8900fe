/** What a loop has recorded, and what of it the page shows. */

import type { LiveController, RanMessage } from "./messages.ts";

/** A value this near to a limit, as a share of the range, stands at it: `scores/effort.py`. */
const AT_LIMIT = 1e-9;

export class Recorded {
  /** Row by row [samples × outputs], of which the first are computed. */
  readonly #rows: Float64Array;
  readonly #outputs: number;
  readonly samples: number;

  constructor(rows: Float64Array, outputs: number, samples: number) {
    this.#rows = rows;
    this.#outputs = outputs;
    this.samples = samples;
  }

  /** Return an output at a sample; NaN where it is not computed. */
  at(sample: number, column: number): number {
    return sample < this.samples ? this.#rows[sample * this.#outputs + column]! : NaN;
  }

  /** Return an output at every sample. */
  column(column: number): Float64Array {
    const values = new Float64Array(this.samples);
    for (let sample = 0; sample < this.samples; ++sample) values[sample] = this.at(sample, column);
    return values;
  }
}

type Shown = Pick<RanMessage, "curves" | "limits" | "spills">;

/** Return what is shown of a run: curves at the samples of each event, limits and what was spilt. */
export function shownOf(
  record: Recorded, controller: LiveController, events: number[][], period: number,
): Shown {
  const curves = events.map((samples) =>
    controller.signals.map(
      (signal) =>
        signal && Float64Array.from(samples, (each) => record.at(each, signal.column) * signal.factor),
    ),
  );
  const limits = controller.limits.map(({ name, column, low, high }) => {
    const [from, to] = [low ?? -Infinity, high ?? Infinity];
    const tolerance = Number.isFinite(to - from) ? AT_LIMIT * (to - from) : 0;
    const held = record.column(column);
    const lasting = (stands: (value: number) => boolean): number =>
      held.filter(stands).length * period;
    return {
      name,
      low: lasting((value) => value <= from + tolerance),
      high: lasting((value) => value >= to - tolerance),
    };
  });
  const spills = controller.spills.map(({ name, column, factor, unit }) => ({
    name,
    amount: record.at(record.samples - 1, column) * factor,
    unit,
  }));
  return { curves, limits, spills };
}
