/** The settings of a loop as they are typed, checked, in SI. */

import type { Form } from "./laws_data.ts";
import type { TypedLoop } from "./typed_loops.ts";

/** What stands in the fields of a loop. */
export interface TypedTexts {
  gain: string;
  integral: string;
  derivative: string;
  weight: string;
  filter: string;
}

const LARGEST = 1e9;
/** The shortest time that a law takes [s]. */
const SHORTEST = 1e-6;
/** Derivative time over the time constant of its filter, where nothing is typed. */
const USUAL_FILTER = 10;

/** What is missing or wrong in a loop, and in which fields. */
export class WrongLoop {
  readonly words: string;
  readonly parts: (keyof TypedTexts)[];

  constructor(words: string, ...parts: (keyof TypedTexts)[]) {
    [this.words, this.parts] = [words, parts];
  }
}

/** Return a loop, or what is missing or wrong. `scale`: what a gain of one is in SI. */
export function typedLoop(name: string, texts: TypedTexts, form: Form, scale: number): TypedLoop | WrongLoop {
  const isParallel = form === "parallel";
  const wrong = (symbol: string, part: keyof TypedTexts, wanted: string): WrongLoop =>
    new WrongLoop(`${name}, ${symbol}: “${texts[part].trim().slice(0, 30)}” is not ${wanted}.`, part);
  const gain = numberOf(texts.gain);
  if (!texts.gain.trim() && !isParallel) return new WrongLoop(`Type K of ${name}.`);
  if (isParallel && ![texts.gain, texts.integral, texts.derivative].some((each) => each.trim())) return new WrongLoop(`Type K, Ki or Kd of ${name}.`);
  if (!(Math.abs(gain ?? 0) <= LARGEST)) return wrong("K", "gain", "a number");
  const [integral, derivative, weight] = [numberOf(texts.integral), numberOf(texts.derivative), numberOf(texts.weight) ?? 1];
  if (!(weight >= 0 && weight <= 1)) return wrong("b", "weight", "a number from 0 to 1");
  const filter = numberOf(texts.filter);
  if (isParallel) {
    const gains = [gain ?? 0, integral ?? 0, derivative ?? 0];
    if (!(Math.abs(integral ?? 0) <= LARGEST)) return wrong("Ki", "integral", "a number");
    if (!(Math.abs(derivative ?? 0) <= LARGEST)) return wrong("Kd", "derivative", "a number");
    if (gains.some((each) => each > 0) && gains.some((each) => each < 0)) 
      return new WrongLoop(`${name}: K, Ki and Kd have to have one sign.`, "gain", "integral", "derivative");
    const usual = derivative && gain ? derivative / gain / USUAL_FILTER : 1;
    if (filter !== null && !(filter >= SHORTEST && filter <= LARGEST)) return wrong("Tf", "filter", "a time above 0");
    return { gain: gains[0]! * scale, integral: gains[1]! * scale, derivative: gains[2]! * scale, weight, filter: filter ?? usual };
  }
  if (integral !== null && !(integral >= SHORTEST && integral <= LARGEST)) return wrong("Ti", "integral", "a time above 0");
  if (derivative !== null && !(derivative >= 0 && derivative <= LARGEST)) return wrong("Td", "derivative", "a time, 0 or above");
  if (filter !== null && !(filter >= 1 && filter <= 1000)) return wrong("N", "filter", "a number from 1 to 1000");
  return { gain: gain! * scale, integral: integral ?? Infinity, derivative: derivative ?? 0, weight, filter: filter ?? USUAL_FILTER };
}

/** A setting of a loop as a report copies it. */
export interface PastedSetting {
  loop: string;
  symbol: string;
  value: string;
  unit: string;
}

/** Return the settings of a pasted text, of which each is a line: loop, symbol, value and unit between tabs. */
export function pastedSettings(text: string): PastedSetting[] {
  return text.split(/\r?\n/).flatMap((line) => {
    const [loop, symbol, value, unit = ""] = line.split("\t").map((each) => each.trim());
    return loop && symbol && value && Number.isFinite(numberOf(value)) ? [{ loop, symbol, value, unit }] : [];
  });
}

/** Return a number, null where nothing is typed, NaN where it is none. */
function numberOf(text: string): number | null {
  const typed = text.trim().replace(",", ".").replace("−", "-");
  return typed ? Number(typed) : null;
}
