/** What the page carries as JSON beside its words. */

import type { LiveData } from "./live/messages.ts";

/** A larger max|S| is too little of a margin. */
export const PEAK_LIMIT = 2;

export interface Controller {
  title: string;
  /** How far it can be trusted, in a word. */
  standing: string;
  /** max|S|; null without a linear loop. */
  peak: number | null;
  /** Mean error, as a multiple of that of the first. */
  error: number | null;
}

export interface Signal {
  name: string;
  unit: string;
  /** Whether it keeps its value for a sample. */
  held: boolean;
  low: number | null;
  high: number | null;
  /** Between which values a level has to stay. */
  band: [number, number] | null;
}

/** Curves of one signal, each whole steps and then differences, with null for no number. */
interface Trace {
  step: number;
  curves: Coded[];
  /** One that all controllers follow, or of inner loops each controller's own. */
  setpoints: (Coded | null)[];
}

export interface ScenarioEvent {
  title: string;
  /** Seconds from one sample to the next. */
  period: number;
  samples: Coded;
  /** From when to when it is seen at first [s]. */
  view: [number, number];
  /** Whether the same signal has stepped before. */
  again: boolean;
  traces: Trace[];
}

export interface PageData {
  controllers: Controller[];
  /** The controllers that are shown at first, the recommended one before its rival. */
  first: number[];
  signals: Signal[];
  events: ScenarioEvent[];
  sensitivity: Sensitivity | null;
  /** What the first controllers need to be tried with other settings. */
  live?: LiveData | null;
}

/** The largest singular value of S over frequency [rad/s], by controller. */
export interface Sensitivity {
  frequencies: number[];
  curves: ((number | null)[] | null)[];
}

type Coded = (number | null)[];

/** Return the data of the page, if it has any. */
export function pageData(): PageData | undefined {
  const text = document.getElementById("data")?.textContent;
  return text ? (JSON.parse(text) as PageData) : undefined;
}

/** Return the numbers that differences of whole steps stand for. */
export function decoded(coded: Coded, step: number): (number | null)[] {
  let whole = 0;
  return coded.map((difference) => {
    if (difference === null) return null;
    whole += difference;
    return whole * step;
  });
}
