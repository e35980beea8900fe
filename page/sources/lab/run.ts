/** A run of the rig: what hands did, what it did, and where each controller stood on the way. */

import type { Start, Touch } from "./data.ts";
import { History } from "./history.ts";
import type { Happening } from "./watches.ts";

/** Where a controller with its process stood before a sample. */
export interface Snapshot {
  sample: number;
  state: Float64Array;
  rings: Float64Array;
}

export class Run {
  name: string;
  isPinned = false;
  readonly start: Start;
  /** The run that it branched off, and the sample from which it is another one. */
  readonly parent: Run | undefined;
  readonly forkedAt: number;
  /** In the order of their samples; some may be still to come. */
  readonly touches: Touch[];
  /** Controller to what the reader calls it, where that is another name than the page has for it. */
  readonly titles: Record<string, string> = {};
  readonly history: History;
  /** Of each controller, in the order of their samples. */
  readonly snapshots: Snapshot[][];
  readonly happened: Happening[] = [];
  /** How many samples it is to have; those of its history are computed. */
  samples = 0;

  constructor(name: string, start: Start, history: History, controllers: number, touches: Touch[] = [], parent?: Run, forkedAt = 0) {
    this.name = name;
    this.start = start;
    this.history = history;
    this.touches = touches;
    this.parent = parent;
    this.forkedAt = forkedAt;
    this.snapshots = Array.from({ length: controllers }, () => []);
  }

  /** Return a run with the same past up to a sample. */
  fork(name: string, sample: number): Run {
    const touches = this.touches.slice(0, this.touchesBefore(sample));
    const other = new Run(name, this.start, this.history.fork(sample), this.snapshots.length, touches, this, sample);
    this.snapshots.forEach((each, place) => other.snapshots[place]!.push(...each.filter((snapshot) => snapshot.sample < sample)));
    other.happened.push(...this.happened.filter((each) => each.sample < sample));
    other.samples = sample;
    Object.assign(other.titles, this.titles);
    return other;
  }

  /** Return how many touches come before a sample's own. */
  touchesBefore(sample: number): number {
    let [low, high] = [0, this.touches.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.touches[middle]!.sample < sample) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
