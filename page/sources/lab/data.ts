/** What the page of a laboratory carries, and what a session of it is. */

import type { RingOfState } from "../live/messages.ts";

export type Start = "rest" | "empty";

export interface ShownSignal {
  name: string;
  words: string;
  unit: string;
  /** Display units in one of SI. */
  factor: number;
  /** Ends of its range [SI]; null where it is open. */
  low: number | null;
  high: number | null;
}

/** What one faceplate holds: measurements with setpoints, and what moves them. */
export interface LoopData {
  controls: string[];
  moves: string[];
}

export interface ControllerData {
  name: string;
  title: string;
  /** Its place among the modules. */
  module: number;
  /** Name and value at rest [SI], in the order of the program. */
  inputs: [string, number][];
  outputs: string[];
  parameters: number[];
  rings: (RingOfState & { isOfProcess: boolean })[];
  /** How many of the first states are the process's. */
  moving: number;
  starts: Record<Start, { state: number[]; rings: number[] }>;
  loops: LoopData[];
}

export interface Spill {
  tank: string;
  /** The output that adds up what it spilt. */
  total: string;
  factor: number;
  unit: string;
}

export interface LabData {
  form: number;
  version: string;
  digest: string;
  process: string;
  /** What files of it are called. */
  name: string;
  /** Sampling period [s]. */
  period: number;
  signals: ShownSignal[];
  controlled: string[];
  inputs: string[];
  disturbances: string[];
  /** Of the noise. */
  seed: number;
  noises: { input: string; stream: number; deviation: number }[];
  spills: Spill[];
  controllers: ControllerData[];
  /** Base64 of deflated WebAssembly. */
  modules: string[];
}

/** A hand on the rig before a sample: an input of the program in SI, or who has the rig or whether sensors are noisy from then on. */
export type Touch =
  | { sample: number; input: string; value: number }
  | { sample: number; controller: string }
  | { sample: number; noise: boolean };

export interface SessionFile {
  form: number;
  version: string;
  digest: string;
  process: string;
  controllers: string[];
  start: Start;
  samples: number;
  seed: number;
  touches: Touch[];
}
