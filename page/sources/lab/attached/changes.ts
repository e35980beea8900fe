/** What others do to a running rig, found in its samples: what moves it is another than before. */

import { port } from "../acknowledging.ts";
import type { Hand, PlantData, Touch } from "../data.ts";
import { WIRES } from "../touch_words.ts";
import { NOISE } from "./cells.ts";

/** Returns what the columns of a row hold. */
type Row = (name: string) => number;

export class Changes {
  private readonly watched: [name: string, hand: (value: number) => Hand][];

  constructor({ controlled, inputs, measurements, disturbances, alarms }: PlantData, columns: readonly string[]) {
    const set = (input: string): [string, (value: number) => Hand] => [input, (value) => ({ input, value })];
    const all = [
      ...controlled.map((name) => set(`${name}.setpoint`)),
      ...inputs.flatMap((name) => ["mode", "manual", "stopped", "stiction"].map((part) => set(`${name}.${part}`))),
      // What a sensor is stuck at is told with that it is stuck.
      ...measurements.flatMap((name) => ["reading", "forced", "sensor"].map((part) => set(`${name}.${part}`))),
      ...measurements.map((name): (typeof this.watched)[number] => [`${name}.drift`, (rate) => ({ drift: name, rate })]),
      ...disturbances.map(set),
      ...alarms.map((alarm) => set(port(alarm))),
      ...Object.values(WIRES).map(set),
      [NOISE, (value: number) => ({ noise: value !== 0 })] as (typeof this.watched)[number],
    ];
    const known = new Set(columns);
    this.watched = all.filter(([name]) => known.has(name));
  }

  /** Return the touches of a sample, by what moves it and what moved the one before. */
  between(before: Row, now: Row, sample: number): Touch[] {
    const found: Touch[] = [];
    for (const [name, hand] of this.watched) {
      const value = now(name);
      if (value !== before(name)) found.push({ sample, ...hand(value) });
    }
    return found;
  }
}
