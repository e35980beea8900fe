/** Stretches of a run as files. */

import type { PlantData, ShownSignal } from "./data.ts";
import { type Column, columnOf, csvParts, type Groups, matRecord } from "./record.ts";
import type { Past } from "./thinned.ts";

/** Rows that a record has at least and at most. */
const [FEWEST, MOST] = [30, 100_000];
/** Of a record, what is fitted; the rest validates. */
const FITTED = 2 / 3;

/** Return a stretch, the last sample included, as the parts of a CSV file. */
export function csvOf(data: PlantData, signals: Map<string, ShownSignal>, past: Past, [first, last]: [number, number]): string[] {
  const { y, yref, u, d } = groupsOf(data, signals, past, first, last);
  return csvParts(first, data.period, [...y, ...yref, ...u, ...d]);
}

/** Return a stretch, the last sample included, as a MAT file. */
export function matOf(
  data: PlantData, signals: Map<string, ShownSignal>, past: Past, [first, last]: [number, number],
): Uint8Array<ArrayBuffer> {
  return matRecord(first, data.period, groupsOf(data, signals, past, first, last));
}

/** Return why `clepsydra identify` would refuse a stretch in which one of these is to move; empty where it would not. */
export function doubtOf(past: Past, first: number, last: number, moved: string[]): string {
  const samples = last - first + 1;
  if (samples < FEWEST) return `Only ${samples} samples are marked; a record needs at least ${FEWEST}.`;
  if (samples > MOST) return `${samples} samples are marked; a record has at most ${MOST}. Set the cursors closer together.`;
  const moves = (name: string): boolean => {
    const values = past.values(name, first, first + Math.ceil(FITTED * samples));
    return values.some((value) => value !== values[0]);
  };
  const [one, ...more] = moved;
  return moved.some(moves) ? "" : `${more.length ? "Every input" : one} stands still in the first two thirds of the record: set the cursors around a step of it.`;
}

function groupsOf(data: PlantData, signals: Map<string, ShownSignal>, past: Past, first: number, last: number): Groups {
  const columns = (names: string[], end = ""): Column[] =>
    names.map((name) => columnOf(signals.get(name)!, name + end, past.values(name + end, first, last + 1)));
  const { controlled, measurements, inputs, disturbances } = data;
  // What is controlled comes first, so that y1 belongs to yref1.
  const others = measurements.filter((name) => !controlled.includes(name));
  return { y: columns([...controlled, ...others]), yref: columns(controlled, ".setpoint"), u: columns(inputs), d: columns(disturbances) };
}
