/** How a running rig stands: what must catch the eye, in a line, and whether hands may move it. */

import { numberText } from "../../words.ts";

/** Whether the controller on the wires gives signs of life, or has never given any. */
export type Heard = "none" | "heard" | "silent";

export interface Standing {
  /** Whether the rig is heard by the page. */
  isOpen: boolean;
  /** Another plant is there instead. */
  isAnother: boolean;
  /** Since the last sample came [s]. */
  age: number;
  /** Between two samples, as the clock on the wall has it [s]. */
  period: number;
  isRemote: boolean;
  heard: Heard;
  /** What is seen is how it was. */
  isPast: boolean;
  /** Nothing that the page asks for is done. */
  isViewer: boolean;
}

/** A plant is late after so many samples, and so long [s]. */
const [LATE_SAMPLES, LATE] = [3, 2];

/** Whether nothing new is known of the plant. */
export function isStale({ isOpen, isAnother, age, period }: Standing): boolean {
  return !isOpen || isAnother || age > LATE_SAMPLES * period + LATE;
}

/** Return what must be seen at once, without how long it has been so; "" where all is well. */
export function alarmWords(standing: Standing): string {
  if (standing.isAnother) return "Another rig is at work here now: load its page.";
  if (!standing.isOpen) return "Connection lost: nothing here is live. Connecting again";
  if (isStale(standing)) return "The plant stands still: no sample comes";
  return standing.isRemote && standing.heard === "silent" ? "Controller silent: outputs are fail-safe." : "";
}

/** Return how old the last sample is, where that matters. */
export function ageWords(standing: Standing): string {
  return isStale(standing) && !standing.isAnother ? `, the last sample is ${ageText(standing.age)} old` : "";
}

/** Return why hands may not move the plant; "" where they may. */
export function heldWords(standing: Standing): string {
  if (isStale(standing)) return "Nothing can be set now.";
  if (standing.isViewer) return "This page only looks on.";
  return standing.isPast ? "This is how it was: go back to now to set anything." : "";
}

/** Return an age in whole seconds, minutes or hours. */
export function ageText(seconds: number): string {
  const [length, unit] = seconds < 120 ? [1, "s"] : seconds < 7200 ? [60, "min"] : [3600, "h"];
  return `${numberText(Math.floor(seconds / length))} ${unit}`;
}
