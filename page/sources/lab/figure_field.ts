/** The field of a figure: typed by the reader and judged, or told as the page measured it. */

import { roundedText } from "../words";
import { element } from "./faceplates.ts";
import type { Verdict } from "./judged.ts";
import type { FigureData } from "./lesson_data.ts";

const WAITING = "measured when the steps are reached";

export interface FigureField {
  place: HTMLElement;
  tell(words: string): void;
}

export function judgedField(figure: FigureData, before: string, isForLecturer: boolean, typed: (text: string) => Verdict): FigureField {
  const place = element("p", "figure");
  const label = element("label", "", figure.symbol ? `${figure.words}, ${figure.symbol} ` : `${figure.words} `);
  const told = element("span", "verdict", "");
  const tell = (words: string): void => {
    const text = figure.measure && !words ? WAITING : words;
    if (told.textContent !== text) told.textContent = text;
    place.classList.toggle("waiting", text === WAITING);
  };
  if (figure.measure) {
    const value = element("output", "", "");
    value.append(told);
    label.append(value);
    place.append(label);
  } else {
    const field = Object.assign(element("input", ""), { type: "text", inputMode: "decimal", size: 9, autocomplete: "off", value: before });
    const judge = (): void => {
      const { isFine, words } = typed(field.value);
      place.classList.toggle("right", isFine);
      tell(words);
    };
    field.addEventListener("change", judge);
    told.setAttribute("role", "status");
    label.append(field, `\u00a0${figure.unit}`);
    place.append(label, " ", told);
    if (before) judge();
  }
  if (isForLecturer && figure.answer !== null)
    place.append(element("span", "answer", ` ${`${roundedText(figure.answer, 4)} ${figure.unit}`.trim()}, ± ${roundedText(100 * figure.tolerance, 2)} %`));
  return { place, tell };
}
