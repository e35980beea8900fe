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
  /** Of the ranking, in the order of its columns behind "standing". */
  columns: LiveColumn[];
  /** The first sample of each event of the overlay; its `samples` count from there. */
  starts: number[];
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
  /** Its words of 32 bits, the lowest first. */
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
  /** What is made of two of them; "": the first is the score. */
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

/** What a tank makes of these loads, each with its first sample and that behind its last. */
export interface OutflowScore {
  key: string;
  kind: "outflow_overshoot" | "outflow_swings" | "volume_used";
  /** Outputs of the loop: the outflow and the inflow, or of the volume used the filling. */
  columns: number[];
  loads: [first: number, stop: number][];
}

/** A column of the ranking, made of scores, each by its number among those of a controller. */
export interface LiveColumn {
  title: string;
  /**
   * figure: the largest of the parts, value · scale.
   * multiples: the mean over the groups of the mean of their multiples of the best, over `least`.
   * peak: max|S|.
   */
  kind: "figure" | "multiples" | "peak";
  parts: { score: number; scale: number }[];
  groups: Multiple[][];
  least: number;
  unit: string;
  /** Significant digits; 0: a whole number. */
  digits: number;
  /** A time, "never" where it is infinite. */
  time: boolean;
  /** Above what it has to be watched, and how that begins; null for no such limit. */
  limit: { most: number; words: string } | null;
}

/** A score as a multiple of the best of the study, of which `smallest` counts as nothing. */
export interface Multiple {
  /** Null where the page has none: it counts as infinite. */
  score: number | null;
  /** Null where none is finite: every finite one is 1 then. */
  best: number | null;
  smallest: number;
  /** Whether less is better. */
  less: boolean;
}

export interface LiveController {
  /** Its place among the controllers of the page. */
  controller: number;
  name: string;
  /** The law's parameters, as recommended. */
  values: number[];
  loop: LoopProgram;
  scores: LiveScore[];
  /** For each row of charts the output of `loop`, and how many units are one of SI; null: no live curve. */
  signals: ({ column: number; factor: number } | null)[];
  /** Of the manipulated variables; null where there is none. */
  limits: { name: string; column: number; low: number | null; high: number | null }[];
  /** Outputs that count what a tank has spilt. */
  spills: { name: string; column: number; factor: number; unit: string }[];
  /** Levels with a band, each with the number of the score that says how long loads drive it out. */
  bands: { name: string; score: number }[];
  law: LawProgram;
  slopes: SlopesProgram | null;
  plant: SampledPlant | null;
  /** Of each loop: what study files call it, what the reader reads, its settings. */
  loops: { loop: string; title: string; settings: LiveSetting[] }[];
  /** The values that grow as it gets bolder by a factor, each with its power; none: it has no such slider. */
  bolder: [value: number, power: number][];
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

/** A delay ring: what it holds at first, and how far its oldest entry moves in a sample. */
export interface RingOfState {
  initial: number;
  length: number;
  turns: number;
}

/** The law alone, whose state at rest follows its values. */
export interface LawProgram {
  module: number;
  state: number[];
  /** Places of delay rings: here ordinary states, which stay as they are. */
  rings: number[];
  manual: number[];
  automatic: number[];
  /** At least so many samples, and at most, until nothing moves by more than a rounding. */
  samples: number;
  most: number;
  rounding: number;
}

/** The derivatives of the law at rest as a program of its values, then of the state in which it rests. */
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
  /** Float64: held [N,N], moved [N,m], measured [p,N], controlled [q,N], enters [p,q], sizes [q], ranges of what is moved [m]. */
  packed: string;
  measurements: string[];
  controlled: string[];
  manipulated: string[];
  /** Measurements of inner loops, which are not controlled. */
  inner: string[];
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
  /** Of each event of the overlay its samples, counted from its start. */
  samples: number[][];
  /** At which S is told [rad/s]. */
  frequencies: number[];
}

/** Run the scenario; a newer run takes the place of one that waits, or goes on after its first look. */
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
  /** Of each column; NaN for none, before the run is whole, and for a peak, which is found later. */
  numbers: number[];
  /** How long each manipulated variable has stood at its limits [s]. */
  limits: { name: string; low: number; high: number }[];
  spills: { name: string; amount: number; unit: string }[];
  /** How long each level was out of its band [s]; none before the run is whole. */
  bands: { name: string; seconds: number }[];
  milliseconds: number;
}

/** Follows a whole run of a controller with a linear loop. */
export interface AnalysedMessage {
  kind: "analysed";
  run: number;
  controller: number;
  /** max|S|; infinite where the loop is unstable, NaN where it has no linear model. */
  peak: number;
  stable: boolean;
  /** The largest singular value of S at each frequency that was asked for; NaN where there is none. */
  sensitivity: number[];
  /** None of a loop that is unstable. */
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
  /** max|S| of the channel. */
  peak: number;
}
