/** What the page of a laboratory carries about laws that take numbers of its reader. */

import type { LawProgram, LiveSetting, SampledPlant, SlopesProgram } from "../live/messages.ts";

export interface LawsData {
  /** One percent of each signal that has a range [SI]. */
  percent: Record<string, number>;
  /** Other units in which the file of the process has some signals, and what one of each is [SI]. */
  units: Record<string, OtherUnit[]>;
  /** Of the controllers with which the page was written, which settings move. */
  given: {
    loops: { loop: string; title: string; settings: LiveSetting[] }[];
    bolder: [value: number, power: number][];
  }[];
  free: FreeLaw[];
  plants: SampledPlant[];
  /** Regulators that the page brings along: bytes of MAT files in base64 of zlib's deflate. */
  files?: { name: string; content: string }[];
}

export interface OtherUnit {
  unit: string;
  size: number;
}

interface Free {
  /** Its place among the controllers. */
  controller: number;
  /** The process as its sampled loop has it, among `plants`; null where it has none. */
  plant: number | null;
}

/** How the actions of a typed loop are joined. */
export type Form = "isa" | "series" | "parallel";

/** PID loops of one pairing and form. */
export interface TypedLaw extends Free {
  kind: "pid";
  form: Form;
  law: LawProgram;
  slopes: SlopesProgram | null;
  /** Each loop with the places of its settings among the parameters of the law. */
  pairs: { output: string; input: string; places: Record<string, number> }[];
}

/** Matrices between all that is controlled and all inputs of the process. */
export interface MatricesLaw extends Free {
  kind: "matrices";
  states: number;
  /** Of the numbers of each matrix, row by row, among the parameters of the law. */
  places: Record<"transition" | "error_effect" | "output_effect" | "memory_gain" | "error_gain", number[]>;
  /** Of the fading time of each output. */
  fading: number[];
}

export type FreeLaw = TypedLaw | MatricesLaw;
