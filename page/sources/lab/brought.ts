/** A controller that a reader brings: the numbers that its law gets, and how it is called. */

import type { MetPlant } from "./loop_margins.ts";
import type { LabData, ShownSignal } from "./data.ts";
import type { FreeLaw, LawsData } from "./laws_data.ts";

export interface Brought {
  law: FreeLaw;
  /** What the reader calls it. */
  title: string;
  /** What it is, in a line. */
  words: string;
  /** Of its law, as its program calls them [SI]. */
  settings: Record<string, number>;
  /** What it moves; other inputs stay by hand. */
  moves: string[];
  start: "bumpless" | "zero";
  /** Ask once more; what came with a session has nothing to be asked. */
  again?(): void;
}

/** What dialogs know of the laboratory, and whom they tell. */
export interface Bench {
  data: LabData;
  laws: LawsData;
  modules: WebAssembly.Module[];
  /** Of `laws.plants`, in their order. */
  plants: MetPlant[];
  signals: Map<string, ShownSignal>;
  /** The controller that has the rig. */
  leading(): number;
  /** What a controller was brought for, by its title; none where it is free. */
  held(controller: number): string | undefined;
  switchOn(brought: Brought): void;
}

/** Return the parameters of the law of a controller: name and value with which the page was written. */
export function lawParameters(data: LabData, controller: number): [string, number][] {
  return data.controllers[controller]!.parameters.slice(data.parameters.length);
}

/** Return the whole range of a signal [SI], or one where it has none. */
export function spanOf(signal: ShownSignal): number {
  return signal.low === null || signal.high === null ? 1 : signal.high - signal.low;
}
