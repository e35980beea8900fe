/** What in the process image of a rig a hand sets. */

import type { Hand } from "../data.ts";

/** Whether sensors and noisy disturbances are noisy. */
export const NOISE = "instructor.noise";

export function cellOf(hand: Hand): string {
  if ("input" in hand) return hand.input;
  return "drift" in hand ? `${hand.drift}.drift` : NOISE;
}
