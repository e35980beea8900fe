/** A stretch of a run as files have it: CSV that `clepsydra identify` reads, and MAT. */

import type { ShownSignal } from "./data.ts";
import { matFile, type MatVariable } from "./mat_file.ts";

/** A signal with its values in the unit that the reader sees. */
export interface Column {
  name: string;
  unit: string;
  values: Float64Array;
}

/** What a MAT file calls signals: y1 and yref1 are a controlled variable and its setpoint. */
export interface Groups {
  y: Column[];
  yref: Column[];
  u: Column[];
  d: Column[];
}

/** Rows of a part of a file: one text of all would be too long for a browser. */
const PART = 10_000;
/** Digits that converting to another unit leaves right. */
const DIGITS = 13;

export function columnOf(signal: ShownSignal, name: string, values: Float64Array): Column {
  const { unit, factor } = signal;
  const shown = factor === 1 ? values : values.map((value) => Number((value * factor).toPrecision(DIGITS)));
  return { name, unit: unit || "1", values: shown };
}

/** Return the parts of a CSV file; an input is held from its row to the next. */
export function csvParts(first: number, period: number, columns: Column[]): string[] {
  const heads = columns.map(({ name, unit }) => cell(`${name} [${unit}]`));
  const parts = [`${["time [s]", ...heads].join(",")}\n`];
  const samples = columns[0]?.values.length ?? 0;
  for (let start = 0; start < samples; start += PART) {
    const rows: string[] = [];
    for (let k = start; k < Math.min(start + PART, samples); ++k)
      rows.push([timeOf(first + k, period), ...columns.map(({ values }) => values[k]!)].join(","));
    parts.push(`${rows.join("\n")}\n`);
  }
  return parts;
}

/** Return a MAT file with t, y1 …, yref1 …, u1 …, d1 … as columns, and `signals`, which tells what they are. */
export function matRecord(first: number, period: number, groups: Groups): Uint8Array<ArrayBuffer> {
  const named = (["y", "yref", "u", "d"] as const).flatMap((kind) =>
    groups[kind].map((column, place) => ({ variable: `${kind}${place + 1}`, column })),
  );
  const samples = named[0]?.column.values.length ?? 0;
  const time = Float64Array.from({ length: samples }, (_, k) => timeOf(first + k, period));
  const words = ["t = time [s]", ...named.map(({ variable, column: { name, unit } }) => `${variable} = ${name} [${plain(unit)}]`)];
  const variables: MatVariable[] = [
    { name: "t", values: time },
    ...named.map(({ variable, column }) => ({ name: variable, values: column.values })),
    { name: "signals", rows: words },
  ];
  return matFile(variables);
}

/** Return the time of a sample [s], without the digits that multiplying leaves. */
const timeOf = (sample: number, period: number): number => Number((sample * period).toPrecision(15));

/** Return a unit in letters that every reader of MAT files knows. */
const plain = (unit: string): string => unit.replaceAll("²", "^2").replaceAll("³", "^3").replaceAll("µ", "u").replaceAll("°", "deg");

const cell = (text: string): string => (/[",;\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
