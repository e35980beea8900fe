/** What the page carries of a lesson. */

import type { Takeover } from "./data.ts";

/** A step of a task: what has to hold, all at once, for so many samples in a row. */
export interface ReachData {
  words: string;
  /** Signal, mode, or parameter to its lowest and highest value [SI]; null is open. */
  bands: Record<string, [number | null, number | null]>;
  /** Who has the rig; empty for anyone. */
  controller: string;
  samples: number;
}

/** What is measured of a signal between the ends of two steps; 0 is where the task began. */
export interface MeasureData {
  kind: "mean" | "rise_time" | "overshoot" | "settling_time" | "return_time";
  signal: string;
  target: "setpoint" | "end";
  after: number;
  until: number;
  band: number;
}

export interface FigureData {
  words: string;
  symbol: string;
  unit: string;
  /** Its units in one SI unit of what it measures. */
  factor: number;
  /** In its unit; null where any number is taken. */
  answer: number | null;
  tolerance: number;
  measure: MeasureData | null;
}

export interface TaskData {
  title: string;
  text: string[];
  /** The name of the set-up that the rig has. */
  setup: string;
  start: "stands" | "rest" | "empty";
  controller: string;
  controllerStart: Takeover;
  /** Parameter of the law of that controller, as its program calls it, to its value [SI]. */
  settings: Record<string, number>;
  /** Controlled measurement to its setpoint [SI]. */
  setpoints: Record<string, number>;
  /** Input to where it stands by hand [SI]. */
  manual: Record<string, number>;
  noise: boolean;
  reach: ReachData[];
  figures: FigureData[];
  hints: string[];
  solution: string[];
}

export interface LessonData {
  name: string;
  title: string;
  text: string[];
  variant: number;
  /** Whether this is the lecturer's page. */
  answers: boolean;
  /** Parameters of the process that the reader is to find, and not to read. */
  hides: string[];
  tasks: TaskData[];
}
