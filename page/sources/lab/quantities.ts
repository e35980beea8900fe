/** Signals as the reader sees them: in display units, and typed numbers back in SI. */

import { timeUnit } from "../words.ts";
import type { ShownSignal } from "./data.ts";

/** Return a value [SI] in its display unit. */
export function shownText(signal: ShownSignal, value: number): string {
  const text = panelText(signal, value);
  return signal.unit ? `${text} ${signal.unit}` : text;
}

/** Return the number alone, with as many decimals as its range asks for: steady in width while it moves. */
export function panelText({ factor, low, high }: ShownSignal, value: number): string {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(low === null || high === null ? value : high - low) * factor;
  const decimals = size > 1e-9 ? Math.min(8, Math.max(0, 3 - Math.floor(Math.log10(size)))) : 2;
  return (value * factor).toFixed(decimals).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
}

/** Return the time of a sample as the others of its unit are written, in samples of so long a period [s]. */
export function momentText(sample: number, period: number): string {
  const seconds = sample * period;
  const [unit, length] = timeUnit(seconds);
  return `${(seconds / length).toFixed(length > 1 || period < 1 ? 2 : 0)} ${unit}`;
}

/** Return where a value [SI] stands in its range, as a share; undefined where that is open. */
export function share(signal: ShownSignal, value: number): number | undefined {
  const { low, high } = signal;
  return low === null || high === null || high <= low ? undefined : (value - low) / (high - low);
}

/** Return a typed number in SI, or why it is none that the signal takes. */
export function typed(signal: ShownSignal, text: string): number | string {
  const number = Number(text.trim().replace("−", "-").replace(",", "."));
  const unit = signal.unit ? ` ${signal.unit}` : "";
  if (!text.trim() || !Number.isFinite(number)) return `${signal.name}: “${text.slice(0, 30)}” is not a number; type one in${unit || " its unit"}.`;
  const value = number / signal.factor;
  const [low, high] = [signal.low ?? -Infinity, signal.high ?? Infinity];
  // The ends themselves, however they round.
  if (number === Number((low * signal.factor).toPrecision(12))) return low;
  if (number === Number((high * signal.factor).toPrecision(12))) return high;
  if (value >= low && value <= high) return value;
  const ends = [low, high].map((end) => Number((end * signal.factor).toPrecision(4)));
  return `${signal.name}: ${number}${unit} is outside ${ends[0]} to ${ends[1]}${unit}; type a number between them.`;
}
