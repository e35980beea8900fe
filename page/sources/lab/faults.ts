/** Faults of sensors and of what inputs move: each is some inputs of the program. */

import type { ShownSignal } from "./data.ts";
import type { SeenRig } from "./seen_rig.ts";

export const SENSOR_FAULTS = ["OK", "stuck", "drifting", "out of range", "dead"] as const;
export const ACTUATOR_FAULTS = ["OK", "stopped", "sticking", "stuck"] as const;
export type SensorFault = (typeof SENSOR_FAULTS)[number];
export type ActuatorFault = (typeof ACTUATOR_FAULTS)[number];

/** A sensor drifts by this share of its range in so many samples; beyond its end it reads so much more. */
const [DRIFT, IN_SAMPLES, BEYOND] = [0.1, 1000, 0.05];
/** What sticks has to be asked to go further than this share of its range; what is stuck, further than that. */
const [STICTION, STUCK] = [0.05, 2];

/** Return where a range begins and how long it is; of an open one, as the value has it. */
function range({ low, high }: ShownSignal, value: number): [low: number, span: number] {
  const from = low ?? 0;
  return [from, high === null ? Math.max(Math.abs(value - from), 1) : high - from];
}

export function sensorFault(rig: SeenRig, { name, low, high }: ShownSignal): SensorFault {
  if (rig.value(`${name}.sensor`) === 0) return "dead";
  if (rig.value(`${name}.forced`) === 1) {
    const reading = rig.value(`${name}.reading`);
    return reading > (high ?? Infinity) || reading < (low ?? -Infinity) ? "out of range" : "stuck";
  }
  return rig.drifting(name) ? "drifting" : "OK";
}

export function breakSensor(rig: SeenRig, signal: ShownSignal, fault: SensorFault): void {
  const { name } = signal;
  const now = rig.value(name);
  const [low, span] = range(signal, now);
  const shown = { stuck: now, "out of range": low + (1 + BEYOND) * span, dead: low, OK: NaN, drifting: NaN }[fault];
  const isForced = !Number.isNaN(shown);
  if (isForced) rig.touch(`${name}.reading`, shown);
  set(rig, `${name}.forced`, Number(isForced));
  set(rig, `${name}.sensor`, Number(fault !== "dead"));
  const rate = fault === "drifting" ? (DRIFT * span) / (IN_SAMPLES * rig.data.period) : 0;
  if (rate !== rig.drifting(name)) rig.drift(name, rate);
}

export function actuatorFault(rig: SeenRig, signal: ShownSignal): ActuatorFault {
  if (rig.value(`${signal.name}.stopped`) === 1) return "stopped";
  const band = rig.value(`${signal.name}.stiction`);
  return band > range(signal, 0)[1] ? "stuck" : band > 0 ? "sticking" : "OK";
}

export function breakActuator(rig: SeenRig, signal: ShownSignal, fault: ActuatorFault): void {
  const [, span] = range(signal, 0);
  set(rig, `${signal.name}.stopped`, Number(fault === "stopped"));
  set(rig, `${signal.name}.stiction`, fault === "stuck" ? STUCK * span : fault === "sticking" ? STICTION * span : 0);
}

/** Touch what is not so already. */
function set(rig: SeenRig, input: string, value: number): void {
  if (rig.value(input) !== value) rig.touch(input, value);
}
