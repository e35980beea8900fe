/** What a run of tried settings is worth, in the words and digits of the ranking. */

import { PEAK_LIMIT } from "../data.ts";
import { numberText, roundedText, timeText, timeUnit } from "../words.ts";
import type { AnalysedMessage, ChannelMargins, LiveColumn, LiveData, RanMessage } from "./messages.ts";
import type { Trial } from "./runner.ts";

/** What is known of a run; the linear loop is analysed after it. */
export interface Outcome {
  trial: Trial;
  ran: RanMessage;
  analysed: AnalysedMessage | null;
}

/** Digits of times, margins and amounts. */
const DIGITS = 3;
/** A larger gain margin is told as this. */
const MANY = 100;

/** Return the numbers of the ranking's columns, with max|S| once it is known. */
export function numbersOf({ ran, analysed }: Outcome, columns: LiveColumn[]): number[] {
  return ran.numbers.map((number, place) =>
    columns[place]!.kind === "peak" ? (analysed?.peak ?? NaN) : number,
  );
}

/** Return a number as the ranking has it in a column. */
export function cellText(column: LiveColumn, number: number): string {
  if (Number.isNaN(number) || (column.kind === "figure" && number === 0)) return "–";
  if (column.time) return number === Infinity ? "never" : timeCell(number);
  const text = column.digits ? roundedText(number, column.digits) : wholeText(number);
  return text === "1" && column.unit === "times" ? "once" : `${text} ${column.unit}`.trim();
}

function wholeText(number: number): string {
  return Number.isFinite(number) ? String(Number(number.toFixed(0)) || 0).replace("-", "−") : roundedText(number, 1);
}

function timeCell(seconds: number): string {
  if (!Number.isFinite(seconds)) return roundedText(seconds, DIGITS);
  const [unit, length] = timeUnit(seconds);
  return `${roundedText(seconds / length, DIGITS)} ${unit}`;
}

/** Return a time as a sentence has it, which does not part from its unit. */
function spanText(seconds: number): string {
  return timeText(seconds, "", DIGITS).replace(" ", "\u00a0");
}

/** Return what has to be watched that was not so before, worst first. */
export function warnings(
  { ran, analysed }: Outcome, before: Outcome | undefined, { columns, period }: LiveData, called: string,
): string[] {
  const beside = (text: string, earlier: number) => (earlier > 0 ? ` (${called} ${text})` : "");
  const found: string[] = [];
  if (analysed && !analysed.stable) found.push("The loop is unstable with these settings.");
  else if (analysed && analysed.peak > PEAK_LIMIT)
    found.push(`max|S| is ${roundedText(analysed.peak, DIGITS)}, above ${PEAK_LIMIT}.`);
  columns.forEach((column, place) => {
    const number = ran.numbers[place]!;
    if (!column.limit || !(number > column.limit.most)) return;
    const text = cellText(column, number).replace(" ", "\u00a0");
    const most = `${numberText(column.limit.most)}\u00a0${column.unit}`;
    const earlier = before?.ran.numbers[place] ?? 0;
    found.push(`${column.limit.words} ${text}, above ${most}${beside(cellText(column, earlier), earlier)}.`);
  });
  ran.spills.forEach(({ name, amount, unit }, place) => {
    const earlier = before?.ran.spills[place]?.amount ?? 0;
    const [text, then] = [amount, earlier].map((each) => `${roundedText(each, 2)}\u00a0${unit}`);
    if (amount > earlier && text !== then) found.push(`${name} spills ${text}${beside(then!, earlier)}.`);
  });
  ran.bands.forEach(({ name, seconds }, place) => {
    const earlier = before?.ran.bands[place]?.seconds ?? 0;
    const [text, then] = [seconds, earlier].map(spanText);
    if (seconds >= earlier + period && text !== then)
      found.push(`Loads drive ${name} out of its band for ${text}${beside(then!, earlier)}.`);
  });
  ran.limits.forEach((limit, place) => {
    const ends = ([["high", "upper"], ["low", "lower"]] as const).flatMap(([end, words]) => {
      const earlier = before?.ran.limits[place]?.[end] ?? 0;
      if (limit[end] < earlier + period || spanText(limit[end]) === spanText(earlier)) return [];
      return [`at its ${words} limit for ${spanText(limit[end])}${beside(spanText(earlier), earlier)}`];
    });
    if (ends.length) found.push(`${limit.name} stands ${ends.join(" and ")}.`);
  });
  return found;
}

/** What `marginTexts` tells, as the head of a table. */
export const MARGINS = ["gain may rise", "phase margin", "extra delay"];

/** Return how many times a loop bears its gain, its phase margin, and how much more delay. */
export function marginTexts({ gain, phase, delay }: ChannelMargins): string[] {
  const times = gain < MANY ? `× ${roundedText(gain, 2)}` : `over × ${MANY}`;
  return [times, Number.isFinite(phase) ? `${phase.toFixed(0)}°` : "–", timeCell(delay)];
}
