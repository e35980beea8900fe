/** Text of a file as paragraphs; it never becomes markup, but that *stars* make words stand out. */

import { element } from "./faceplates.ts";

export function paragraphs(texts: string[]): HTMLElement[] {
  return texts.map((text) => {
    const found = element("p", "");
    text.split(/\*([^*]+)\*/).forEach((part, place) => found.append(place % 2 ? element("em", "", part) : part));
    return found;
  });
}
