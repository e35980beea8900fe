/** The states of alarms, as the program of the rig tells them, and what they hold. */

import type { AlarmData } from "./data.ts";

type Value = (name: string) => number;

/** States A to D of ISA-18.2. */
export const [NORMAL, UNACKNOWLEDGED, ACKNOWLEDGED, RETURNED] = [0, 1, 2, 3];

const RANKS = { low: 1, medium: 2, high: 3 };

/** Return the state of an alarm; normal where nothing is known of it yet. */
export function alarmState({ name }: AlarmData, value: Value): number {
  return value(`${name}.state`) || NORMAL;
}

/** Tell whether an alarm is there, whatever an operator has made of it. */
export function isThere(state: number): boolean {
  return state === UNACKNOWLEDGED || state === ACKNOWLEDGED;
}

/** Tell whether an alarm waits to be acknowledged. */
export function isWaiting(state: number): boolean {
  return state === UNACKNOWLEDGED || state === RETURNED;
}

/** Return how soon an operator has to act, as a number: the higher, the sooner. */
export function urgency({ priority }: AlarmData): number {
  return RANKS[priority];
}

/** Return by which alarms an input is held, "HH of level_1"; "" where none holds it. */
export function interlockWords(input: string, alarms: readonly AlarmData[], value: Value): string {
  if (!(value(`${input}.interlock`) > 0)) return "";
  const holding = alarms.filter((alarm) => {
    const state = alarmState(alarm, value);
    return input in alarm.holds && (alarm.latches ? state !== NORMAL : isThere(state));
  });
  return holding.map(({ short, measurement }) => `${short} of ${measurement}`).join(", ");
}
