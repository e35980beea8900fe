/** What moves the plant stands in a group of its own, which is disabled while nothing may be moved. */

import { element } from "../faceplates.ts";

/** Return such a group within a place; it has no look. */
export function acting(place: HTMLElement): HTMLFieldSetElement {
  const group = element("fieldset", "acting");
  place.append(group);
  return group;
}
