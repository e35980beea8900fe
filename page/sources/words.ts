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
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e") as [string, string];
  const power = Number(exponent);
  const text =
    power > -4 && power < 6
      ? Number(`${mantissa}e${power}`).toFixed(Math.max(0, digits - 1 - power))
      : `${mantissa}e${power}`;
  return text.replaceAll("-", "−");
}

/** Return a difference with its sign. */
export function differenceText(value: number): string {
  return (value >= 0 ? "+" : "") + numberText(value, 3);
}
