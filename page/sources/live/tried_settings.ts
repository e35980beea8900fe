/** What the reader has set of a controller: bolder by a factor, and settings of its own. */

import type { LiveController, LiveSetting } from "./messages.ts";

/** Digits of a setting that is not as it was: what is shown is what runs. */
const DIGITS = 4;

/** What is asked of a controller: its settings, and what makes it bolder. */
export type TriedController = Pick<LiveController, "name" | "values" | "loops" | "bolder">;

export class TriedSettings {
  readonly controller: TriedController;
  private factor = 1;
  /** In the unit shown, before the factor. */
  private readonly own = new Map<LiveSetting, number>();

  constructor(controller: TriedController) {
    this.controller = controller;
  }

  /** The law's parameters. */
  get values(): number[] {
    const values = [...this.controller.values];
    for (const [place, power] of this.controller.bolder) values[place]! *= this.factor ** power;
    for (const setting of this.settings)
      if (this.isChanged(setting))
        for (const place of setting.values) values[place] = this.shown(setting) * setting.factor;
    return values;
  }

  get isAsBefore(): boolean {
    return this.factor === 1 && this.own.size === 0;
  }

  get bolder(): number {
    return this.factor;
  }

  set bolder(factor: number) {
    this.factor = factor;
  }

  /** Return a setting in the unit shown. */
  shown(setting: LiveSetting): number {
    if (!this.isChanged(setting)) return setting.value;
    return Number(((this.own.get(setting) ?? setting.value) * this.share(setting)).toPrecision(DIGITS));
  }

  set(setting: LiveSetting, shown: number): void {
    if (shown === setting.value && this.share(setting) === 1) this.own.delete(setting);
    else this.own.set(setting, shown / this.share(setting));
  }

  reset(): void {
    this.factor = 1;
    this.own.clear();
  }

  /** Return a line for each setting: loop, symbol, value and unit, which a spreadsheet takes too. */
  get text(): string {
    // By the name that study files and Python have for the loop.
    const lines = this.controller.loops.flatMap(({ loop, settings }) =>
      settings.map((each) => [loop, each.symbol, this.shown(each), each.unit]),
    );
    const set = new Set(this.settings.flatMap(({ values }) => values));
    if (this.factor !== 1 && this.controller.bolder.some(([place]) => !set.has(place)))
      lines.push([this.controller.name, "all gains", this.factor, "×"]);
    return lines.map((line) => line.join("\t").trimEnd()).join("\n");
  }

  private get settings(): LiveSetting[] {
    return this.controller.loops.flatMap(({ settings }) => settings);
  }

  private isChanged(setting: LiveSetting): boolean {
    return this.own.has(setting) || this.share(setting) !== 1;
  }

  /** Return by how much the factor makes a setting larger. */
  private share(setting: LiveSetting): number {
    const found = this.controller.bolder.find(([place]) => setting.values.includes(place));
    return found ? this.factor ** found[1] : 1;
  }
}
