/** What is abnormal about signals, in a word: limits, faults, and what stands still that should run. */

type Value = (name: string) => number;

/** Bits of a status word. */
const [LOW_LIMIT, HIGH_LIMIT, SENSOR_FAULT, INVALID, RATE_LIMIT] = [4, 8, 16, 32, 128];
/** What a signal that stands at an end of its range may differ by, as a share. */
const CLOSE = 1e-9;
/** A tank that is filled less than this is empty. */
const EMPTY = 1e-3;

export interface Range {
  low: number | null;
  high: number | null;
}

/** Return what a status word says of an output: a fault before a limit, and "" where all is well. */
export function statusWords(status: number): string {
  const word = Number.isFinite(status) ? Math.round(status) : 0;
  if (word & SENSOR_FAULT) return "sensor fault";
  if (word & INVALID) return "invalid input";
  if (word & LOW_LIMIT) return "at low limit";
  if (word & HIGH_LIMIT) return "at high limit";
  return word & RATE_LIMIT ? "at rate limit" : "";
}

/** Tell whether a status word reports a fault. */
export function isFault(status: number): boolean {
  return Number.isFinite(status) && (Math.round(status) & (SENSOR_FAULT | INVALID)) !== 0;
}

/** Return how an actuator differs from what it is asked for; "" where it does not. */
export function actuatorWords(name: string, range: Range, value: Value, flow: number): string {
  const asked = value(name);
  const low = range.low ?? 0;
  if (value(`${name}.stopped`) === 1) return "stopped";
  const applied = value(`${name}.applied`);
  const span = (range.high ?? 1) - low;
  if (Number.isFinite(applied) && Math.abs(applied - asked) > CLOSE * span) return "sticks";
  if (flow === 0 && asked > low + CLOSE * span) return "no flow";
  if (range.high !== null && asked >= range.high - CLOSE * span) return "at its highest";
  return asked <= low + CLOSE * span && range.low !== null ? "at its lowest" : "";
}

/** Return what is abnormal about how full a tank is. */
export function levelWords(share: number | undefined): string {
  if (share === undefined || Number.isNaN(share)) return "";
  return share >= 1 - CLOSE ? "full" : share <= EMPTY ? "empty" : "";
}

/** Return what is wrong with a sensor; "" where nothing is. */
export function sensorWords(name: string, range: Range, value: Value): string {
  if (value(`${name}.sensor`) === 0) return "dead";
  if (value(`${name}.forced`) !== 1) return "";
  const reading = value(`${name}.reading`);
  return reading > (range.high ?? Infinity) || reading < (range.low ?? -Infinity) ? "out of range" : "stuck";
}
