/** Numbers and times as an engineer reads them. */

const UNITS: [string, number, number][] = [
  ["s", 1, 180],
  ["min", 60, 10800],
  ["h", 3600, 259200],
  ["d", 86400, Infinity],
];

/** Return name and length [s] of the unit that suits a span of time [s]. */
export function timeUnit(span: number): [string, number] {
  const [name, length] = UNITS.find(([, , most]) => Math.abs(span) <= most)!;
  return [name, length];
}

export function timeText(seconds: number, plus = "", digits = 4): string {
  const [name, length] = timeUnit(seconds);
  return `${seconds >= 0 ? plus : ""}${numberText(seconds / length, digits)} ${name}`;
}

/** Return a number in some significant digits, with a real minus. */
export function numberText(value: number, digits = 4): string {
  const text = Math.abs(value) < 1e6 ? String(Number(value.toPrecision(digits))) : value.toExponential(2);
  return text.replace("-", "−");
}

/** Return a number with all of its significant digits, also where these are zeros. */
export function roundedText(value: number, digits: number): string {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : value > 0 ? "∞" : "−∞";
  const rounded = Number(value.toPrecision(digits));
  const exponent = rounded ? Math.floor(Math.log10(Math.abs(rounded))) : 0;
  const text = exponent > -4 && exponent < 6 ? rounded.toFixed(Math.max(0, digits - 1 - exponent)) : String(rounded);
  return text.replaceAll("-", "−");
}

/** Return a difference with its sign. */
export function differenceText(value: number): string {
  return (value >= 0 ? "+" : "") + numberText(value, 3);
}
