/** What the page of a laboratory carries, and what a session of it is. */

import type { LawsData } from "./laws_data.ts";
import type { RingOfState } from "../live/messages.ts";
import type { LessonData } from "./lesson_data.ts";

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

/** Where a flow runs: the element that causes it, and its ends; empty outside the plant. */
export interface FlowPath {
  element: string;
  source: string;
  destination: string;
}

/** A program of signals of the process to its flows [m³/s], in the order of the paths. */
export interface FlowsData {
  /** Its place among the modules. */
  module: number;
  inputs: string[];
  /** Those of the inputs that come out of delays. */
  delays: string[];
  parameters: string[];
  paths: FlowPath[];
  /** The greatest flow at rest [m³/s]. */
  much: number;
  unit: string;
  factor: number;
}

/** What switches itself in the process. */
export interface EventData {
  /** The output that counts how often it happened. */
  count: string;
  words: string;
  /** It does harm to the plant. */
  isHarm: boolean;
}

export type Priority = "low" | "medium" | "high";

/** An alarm of a measurement, in the words of ISA-18.2. */
export interface AlarmData {
  /** Its path: outputs are called `${name}.state`, and what acknowledges it `${name}.acknowledge`. */
  name: string;
  measurement: string;
  /** What an operator calls it: "HH". */
  short: string;
  words: string;
  priority: Priority;
  /** Where it comes [SI]; null where that is no level of the measurement. */
  limit: number | null;
  /** Input to the value at which it holds it [SI]. */
  holds: Record<string, number>;
  /** What it holds it holds until it is acknowledged, too. */
  latches: boolean;
}

/** A controller as it is seen, wherever it moves the plant. */
export interface SeenController {
  name: string;
  title: string;
  /** Those of the process, then "controller.…": name and value [SI]. */
  parameters: [string, number][];
  loops: LoopData[];
  /** Output to the parameters of the law that limit it below and above. */
  limits: Record<string, [low: string, high: string]>;
  /** Its place among the drawings. */
  drawing: number;
}

export interface ControllerData extends SeenController {
  /** Its place among the modules. */
  module: number;
  /** Name and value at rest [SI], in the order of the program. */
  inputs: [string, number][];
  outputs: string[];
  states: string[];
  rings: (RingOfState & { name: string; isOfProcess: boolean })[];
  /** How many of the first states are the process's. */
  moving: number;
  starts: Record<Start, { state: number[]; rings: number[] }>;
  /** Its law with nothing in its memory: its states, and what its delays hold. */
  cold: { state: number[]; rings: number[] };
}

/** A parameter of the process. */
export interface ParameterData extends ShownSignal {
  /** [SI] */
  value: number;
}

/** Numbers with which the rig is another one of the same build [SI]. */
export interface Setup {
  name: string;
  title: string;
  /** What it is, where its title does not say it. */
  words: string;
  parameters: Record<string, number>;
}

/** What hands can do to a tank. */
export interface HandsOnTank {
  tank: string;
  /** The input that pours into it. */
  pour: string;
  /** The flow that adds a quarter of its scale in so many samples [m³/s]. */
  full: number;
  samples: number;
  /** The parameter of a hole that is closed, and its area when it is open [m²]. */
  extra_outlet: string;
  area: number;
  /** Element to the parameter that is 0 where it is plugged. */
  outlets: Record<string, string>;
}

export interface Spill {
  tank: string;
  /** The output that adds up what it spilt. */
  total: string;
  factor: number;
  unit: string;
}

/** What a page needs to show a plant, whoever moves it. */
export interface PlantData {
  form: number;
  version: string;
  process: string;
  /** What files of it are called. */
  name: string;
  /** Sampling period [s]. */
  period: number;
  signals: ShownSignal[];
  controlled: string[];
  measurements: string[];
  inputs: string[];
  disturbances: string[];
  parameters: ParameterData[];
  tanks: HandsOnTank[];
  noises: { input: string; stream: number; deviation: number }[];
  spills: Spill[];
  /** States that are levels. */
  levels: string[];
  events: EventData[];
  alarms: AlarmData[];
  /** None where nothing flows. */
  flows: FlowsData | null;
  controllers: SeenController[];
  /** Base64 of deflated WebAssembly. */
  modules: string[];
}

export interface LabData extends PlantData {
  digest: string;
  /** The rig's own first. */
  setups: Setup[];
  /** Of the noise. */
  seed: number;
  /** What the reader is asked to do, if anything. */
  lesson: LessonData | null;
  /** Those that the page was written with, then the free ones of `laws`. */
  controllers: ControllerData[];
  laws: LawsData;
}

/** What the page of a running rig carries. */
export interface AttachedData extends PlantData {
  attached: {
    /** What tells the plant from every other. */
    plant: string;
    /** Times as fast as real time. */
    speed: number;
  };
}

/** What is much alike for all controllers, deflated in a page. */
export interface PackedData extends Pick<LabData, "controllers" | "laws"> {
  /** Those that are not seen at first, as SVG. */
  drawings: string[];
}

/** The data as a page holds them: `packed` is base64 of deflated JSON of `PackedData`. */
export interface HeldData extends Omit<LabData, "controllers" | "laws"> {
  packed: string;
}

/**
 * How a law takes the rig: as it has followed in manual so far; as it would stand after it had
 * followed for long, where its numbers are new; or with its state at zero.
 */
export type Takeover = "bumpless" | "settled" | "zero";

/** What a hand does to the rig. Numbers are in SI. */
export type Hand =
  | { input: string; value: number }
  /** Of the process. */
  | { parameters: Record<string, number> }
  /** Of the law of a controller, as its program calls them. */
  | { settings: Record<string, number>; of: string }
  | { controller: string; start: Takeover }
  | { noise: boolean }
  /** What a sensor drifts by in a second from then on; 0 ends it. */
  | { drift: string; rate: number };

/** A hand before a sample. */
export type Touch = { sample: number } & Hand;

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
  /** Controller to what its reader called it. */
  titles?: Record<string, string>;
}
