/** Water that hands pour: a quarter of a tank at a click, and as long as a button is held. */

import type { HandsOnTank } from "./data.ts";
import type { Rig } from "./rig.ts";

export class Pours {
  private readonly rig: Rig;
  /** Those that a hand holds. */
  private readonly held = new Set<HandsOnTank>();
  /** Samples that are left of a quarter. */
  private readonly left = new Map<HandsOnTank, number>();

  constructor(rig: Rig) {
    this.rig = rig;
  }

  isPouring(tank: HandsOnTank): boolean {
    return this.rig.value(tank.pour) > 0;
  }

  /** Begin to pour, and end it at once where it pours already. */
  press(tank: HandsOnTank): void {
    if (this.isPouring(tank)) {
      this.end(tank);
      return;
    }
    this.rig.touch(tank.pour, tank.full);
    this.held.add(tank);
    this.left.set(tank, tank.samples);
  }

  /** Let go: what has begun of a quarter is still poured. */
  release(tank: HandsOnTank): void {
    this.held.delete(tank);
  }

  /** Before a sample: end what is poured and no longer held. */
  step(): void {
    for (const tank of this.rig.data.tanks) {
      if (!this.isPouring(tank)) continue;
      // Where time was turned back into a quarter, it begins anew.
      const left = this.left.get(tank) ?? tank.samples;
      if (left <= 0 && !this.held.has(tank)) this.end(tank);
      else this.left.set(tank, left - 1);
    }
  }

  private end(tank: HandsOnTank): void {
    this.rig.touch(tank.pour, 0);
    this.held.delete(tank);
    this.left.delete(tank);
  }
}
