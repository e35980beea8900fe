/** Figures of a lesson: what was typed as a number, and whether it is right. */

import { numberText, roundedText } from "../words.ts";
import type { FigureData } from "./lesson_data.ts";

export interface Verdict {
  /** Whether it may stand: right, or any number where no answer is known. */
  isFine: boolean;
  words: string;
}

/** Return a typed number; NaN for none. */
export function typedNumber(text: string): number {
  const plain = text.trim().replaceAll("−", "-").replace(",", ".");
  return plain ? Number(plain) : NaN;
}

/** Judge what was typed for a figure; nothing typed is no mistake yet. */
export function verdict({ answer, tolerance, unit }: FigureData, text: string): Verdict {
  if (!text.trim()) return { isFine: false, words: "" };
  const found = typedNumber(text);
  if (!Number.isFinite(found)) return { isFine: false, words: `“${text.trim().slice(0, 20)}” is not a number; type one${unit ? ` in ${unit}` : ""}` };
  if (answer === null) return { isFine: true, words: "noted" };
  const off = Math.abs(found - answer);
  // Of an answer that is zero there is no share.
  const room = tolerance * (Math.abs(answer) || 1);
  if (off <= room) return { isFine: true, words: "right" };
  return { isFine: false, words: `not within ${numberText(100 * tolerance, 3)} % yet` };
}

/** Return a measured figure [SI] as it is told. */
export function measuredText({ factor, unit }: FigureData, value: number): string {
  const text = roundedText(value * factor, 3);
  return unit && Number.isFinite(value) ? `${text} ${unit}` : text;
}
