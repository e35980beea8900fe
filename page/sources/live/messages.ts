/**
 * What a live report carries under `live` of its data, and what page and worker tell each other.
 *
 * All numbers are SI but where a comment says otherwise. Bytes are base64 of zlib's deflate.
 */

/** The version of all this that the script reads. */
export const FORM = 1;

export interface LiveData {
  form: number;
  period: number;
  samples: number;
  /** A .wasm each, which the programs below share by number. */
  modules: string[];
  /** Of every `loop` below, in the order of its inputs. */
  inputs: InputColumn[];
  scores: LiveScore[];
  /** Of the ranking, in the order of its columns behind "standing". */
  columns: LiveColumn[];
  /** For each row of charts the output of a `loop`, and how many units are one of SI; null: no live curve. */
  signals: ({ column: number; factor: number } | null)[];
  /** The first sample of each event of the overlay; its `samples` count from there. */
  starts: number[];
  /** Of the manipulated variables; null where there is none. */
  limits: { name: string; column: number; low: number | null; high: number | null }[];
  /** Outputs that count what a tank has spilt. */
  spills: { name: string; column: number; factor: number; unit: string }[];
  /** The recommended one, then its rival; one may be missing. */
  controllers: LiveController[];
}

/** An input of a loop over the run: the same for every controller. */
export interface InputColumn {
  /** A Float64 for each sample, little endian; null: `constant` at every sample. */
  packed: string | null;
  constant: number;
  /** Added to it. */
  noise: Noise | null;
}

/** Normal noise for `count` samples from the `first` on, which seed and stream alone determine. */
export interface Noise {
  seed: number[];
  stream: number;
  first: number;
  count: number;
  deviation: number;
}

export type LiveScore = FoldedScore | SettlingScore | OutflowScore;

/** What the loop adds up, at these places of its state. */
export interface FoldedScore {
  key: string;
  kind: "fold";
  states: number[];
  finish: "" | "ratio" | "deviation";
}

/** The longest settling time of an output of the loop after these steps [s]. */
export interface SettlingScore {
  key: string;
  kind: "settling";
  column: number;
  band: number;
  steps: SetpointStep[];
}

/** First sample, sample behind the last, and the setpoint before and after. */
export type SetpointStep = [first: number, stop: number, start: number, target: number];

/** The largest after these loads, each with its first sample and that behind its last. */
export interface OutflowScore {
  key: string;
  kind: "outflow_overshoot" | "outflow_swings" | "volume_used";
  columns: number[];
  loads: [first: number, stop: number][];
}

/** A column of the ranking, made of scores. */
export interface LiveColumn {
  title: string;
  /**
   * figure: the largest part, value · scale.
   * multiples: the mean of the parts as multiples of the best, of which `smallest` counts as nothing.
   * relative: the mean of `criteria`, as a multiple of `least`.
   * peak: max|S|.
   */
  kind: "figure" | "multiples" | "relative" | "peak";
  parts: ColumnPart[];
  criteria?: number[];
  least?: number;
  unit: string;
  /** Significant digits; 0: a whole number. */
  digits: number;
  /** A time, "never" where it is infinite. */
  time?: boolean;
}

export interface ColumnPart {
  score: number;
  scale: number;
  best?: number;
  smallest?: number;
  /** Whether less is better. */
  less?: boolean;
}

export interface LiveController {
  /** Its place among the controllers of the page. */
  controller: number;
  name: string;
  /** The law's parameters, as recommended. */
  values: number[];
  loop: LoopProgram;
  law: LawProgram | null;
  slopes: SlopesProgram | null;
  plant: SampledPlant | null;
  loops: { title: string; settings: LiveSetting[] }[];
  bolder: { values: number[]; words: string } | null;
}

/** A program that computes the whole scenario. */
export interface LoopProgram {
  module: number;
  outputs: number;
  /** At first: that of process, law and scores. */
  state: number[];
  /** Where the law's begins. */
  law: number;
  parameters: number[];
  /** Where the law's values stand among them. */
  first: number;
  rings: RingOfState[];
}

/** A delay ring: where its first entry comes from, and how far its oldest one moves in a sample. */
export interface RingOfState {
  state: number;
  length: number;
  turns: number;
}

/** The law alone, whose state at rest follows its values; null: it does not depend on them. */
export interface LawProgram {
  module: number;
  state: number[];
  manual: number[];
  automatic: number[];
  /** At least so many samples, and at most, until nothing moves by more than a rounding. */
  samples: number;
  most: number;
  rounding: number;
}

/** The derivatives of the law at rest as a program of its values. */
export interface SlopesProgram {
  module: number;
  /** Of each output: step_x 0, step_u 1, output_x 2 or output_u 3, row and column. */
  entries: [matrix: number, row: number, column: number][];
  states: number;
  /** Columns of step_u and output_u: the setpoints, then the measurements. */
  setpoints: number;
  measurements: number;
  outputs: number;
  /** Delay rings: a state, and how many more the ring counts for. */
  longer: [state: number, more: number][];
}

/** The process between samples, as the sampled loop joins it to the law. */
export interface SampledPlant {
  states: number;
  /** Float64: held [N,N], moved [N,m], measured [p,N], controlled [q,N], enters [p,q], sizes [q], input_spans [m]. */
  packed: string;
  names: { measurements: string[]; controlled: string[]; manipulated: string[] };
}

/** A number of a controller that the reader can set, in the unit that is shown. */
export interface LiveSetting {
  symbol: string;
  words: string;
  unit: string;
  value: number;
  /** values[place] = shown · factor, at each of these places. */
  factor: number;
  values: number[];
  /** The ends of the slider. */
  low: number;
  high: number;
  /** What the law takes. */
  least: number;
  most: number;
  logarithmic: boolean;
}

export type PageMessage = LoadMessage | RunMessage;

/** The first message: nothing runs before it. */
export interface LoadMessage {
  kind: "load";
  data: LiveData;
}

/** Run the scenario; a newer run takes the place of one that waits or goes on. */
export interface RunMessage {
  kind: "run";
  run: number;
  /** Its place in `LiveData.controllers`. */
  controller: number;
  values: number[];
}

export type WorkerMessage = ReadyMessage | RefusedMessage | RanMessage | AnalysedMessage;

export interface ReadyMessage {
  kind: "ready";
}

/** Why nothing can run here, in a sentence. */
export interface RefusedMessage {
  kind: "refused";
  words: string;
}

export interface RanMessage {
  kind: "ran";
  run: number;
  controller: number;
  /** Whether all samples are in it; if not, another message follows. */
  whole: boolean;
  /** How many are. */
  samples: number;
  /** Of each event and signal, at the event's samples and in the unit shown; NaN where it is not computed. */
  curves: (Float64Array | null)[][];
  /** Of each column; NaN for none. */
  numbers: number[];
  /** How long each manipulated variable stood at its limits [s]. */
  limits: { name: string; low: number; high: number }[];
  spills: { name: string; amount: number; unit: string }[];
  milliseconds: number;
}

/** Follows a whole run of a controller with a linear loop. */
export interface AnalysedMessage {
  kind: "analysed";
  run: number;
  controller: number;
  /** max|S|; infinite where the loop is unstable. */
  peak: number;
  stable: boolean;
  margins: ChannelMargins[];
}

export interface ChannelMargins {
  name: string;
  /** A factor; infinite where no change is too much. */
  gain: number;
  /** [deg] */
  phase: number;
  /** [rad/s]; NaN where there is none. */
  crossover: number;
  /** [s] */
  delay: number;
}
