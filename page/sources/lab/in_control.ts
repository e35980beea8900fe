/** Which controllers had the rig in a stretch of a run. */

import type { SeenController, Touch } from "./data.ts";

/** What a run knows of its controllers. */
export interface Led {
  readonly touches: readonly Touch[];
  /** What those are called that a reader has brought. */
  readonly titles?: Record<string, string>;
}

/** Return their titles in the order in which each first had it: from before a sample up to another one. */
export function inControl({ touches, titles = {} }: Led, controllers: SeenController[], first: number, last: number): string[] {
  let leading = controllers[0]!.name;
  const found: string[] = [];
  for (const touch of touches) {
    if (touch.sample > last) break;
    if (!("controller" in touch)) continue;
    if (touch.sample > first) found.push(leading);
    leading = touch.controller;
  }
  const title = (name: string): string => titles[name] ?? controllers.find((each) => each.name === name)!.title;
  return [...new Set([...found, leading].map(title))];
}
