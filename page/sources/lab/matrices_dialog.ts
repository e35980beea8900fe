/** A regulator from a file, before it has the rig: where it goes, in which units and with which sign. */

import { eigenvalues } from "../live/eigenvalues.ts";
import type { SampledSystem } from "../live/response.ts";
import { type Bench, lawParameters, spanOf } from "./brought.ts";
import { Dialog, selectOf } from "./dialog.ts";
import type { ShownSignal } from "./data.ts";
import { errorResponsesTold } from "./error_responses.ts";
import { element } from "./faceplates.ts";
import type { MatricesLaw } from "./laws_data.ts";
import { type ConditionedMatrices, inSi, sampledAt, toldByOwnObserver, unconditioned, widened } from "./linear_law.ts";
import { type LoopMargins, loopMargins, ratesOf } from "./loop_margins.ts";
import { marginsTold, polesText } from "./margins_told.ts";
import { Refused } from "./refused.ts";
import type { GivenRegulator } from "./regulator_file.ts";
import { UnitsAsked } from "./units_asked.ts";

const SIGNS: [string, -1 | 1][] = [["r − y, setpoint minus measurement", -1], ["y − r, measurement minus setpoint", 1]];
const NO_OBSERVER =
  "It has a mode that does not die out and that no error reaches or no output shows, so anti-windup is not possible: it can only start from zero state, without.";

/** What follows from all answers. */
interface Found {
  told: ConditionedMatrices | null;
  deaf: ConditionedMatrices;
  margins: LoopMargins | null;
  system: SampledSystem;
}

export class MatricesDialog {
  private readonly bench: Bench;
  private readonly laws: MatricesLaw[];
  private readonly dialog = new Dialog();
  private readonly about = element("p", "");
  private readonly ends = element("div", "ends");
  private readonly inputUnits: UnitsAsked;
  private readonly outputUnits: UnitsAsked;
  private readonly sign: HTMLSelectElement;
  private readonly room = element("select", "");
  private readonly roomAsked = element("p", "asked");
  private readonly told = element("div", "told-law");
  private readonly bumpless: HTMLButtonElement;
  private readonly zero: HTMLButtonElement;
  private given!: GivenRegulator;
  private sampled!: ReturnType<typeof sampledAt>;
  private inputs: HTMLSelectElement[] = [];
  private outputs: HTMLSelectElement[] = [];
  private found: Found | null = null;

  constructor(bench: Bench) {
    this.bench = bench;
    this.laws = bench.laws.free.filter((each) => each.kind === "matrices");
    const changed = (): void => this.answer();
    this.inputUnits = new UnitsAsked("Its inputs, the errors, are in", changed);
    this.outputUnits = new UnitsAsked("Its outputs are in", changed);
    const sign = selectOf("Its inputs are", ["choose…", ...SIGNS.map(([words]) => words)]);
    this.sign = sign.select;
    this.sign.addEventListener("change", changed);
    const asked = element("p", "asked");
    asked.append(sign.label);
    const label = element("label", "", "It replaces ");
    label.append(this.room);
    this.room.addEventListener("change", changed);
    this.roomAsked.append(label);
    this.told.setAttribute("aria-live", "polite");
    this.dialog.body.append(this.about, this.ends, this.inputUnits.place, this.outputUnits.place, asked, this.roomAsked, this.told);
    this.bumpless = this.dialog.button("Switch on without a bump", () => this.switchOn("bumpless"));
    this.zero = this.dialog.button("Switch on from zero state, no anti-windup", () => this.switchOn("zero"));
    this.dialog.button("Cancel", () => this.dialog.close());
  }

  /** Ask what a regulator needs, which no answer of another one tells; refuse one that does not fit this process. */
  open(given: GivenRegulator): void {
    const { data } = this.bench;
    const [inputs, outputs] = [given.B.columns, given.C.rows];
    const [most, moved] = [data.controlled.length, data.inputs.length];
    if (!this.laws.length) throw new Refused(given.name, "a regulator", "a process that can have one here", "give it to clepsydra simulate");
    if (inputs > most || outputs > moved) {
      const expected = `at most ${countText(most, "input")}, the error of ${data.controlled.join(", ")}, and ${countText(moved, "output")}, for ${data.inputs.join(", ")}`;
      throw new Refused(given.name, `${countText(inputs, "input")} and ${countText(outputs, "output")}`, expected, "choose the regulator of this process");
    }
    if (inputs > outputs)
      throw new Refused(given.name, `${countText(inputs, "input")} for ${countText(outputs, "output")}`, "no more errors than outputs", "choose a regulator of fewer errors");
    this.sampled = sampledAt(data.period, given);
    this.given = given;
    this.about.textContent = this.aboutText();
    const rows = (count: number, words: (each: number) => string, names: string[]): [HTMLElement[], HTMLSelectElement[]] => {
      const made = Array.from({ length: count }, (_, each) => selectOf(words(each), names, each));
      made.forEach(({ select }) => select.addEventListener("change", () => (this.askUnits(), this.answer())));
      return [made.map(({ label }) => label), made.map(({ select }) => select)];
    };
    const [inputLabels, inputSelects] = rows(inputs, (each) => `Input ${each + 1} is the error of`, data.controlled);
    const [outputLabels, outputSelects] = rows(outputs, (each) => `Output ${each + 1} moves`, data.inputs);
    [this.inputs, this.outputs] = [inputSelects, outputSelects];
    this.ends.replaceChildren(...inputLabels, ...outputLabels);
    this.sign.selectedIndex = 0;
    this.askForRoom();
    this.inputUnits.forget();
    this.outputUnits.forget();
    this.askUnits();
    this.answer();
    this.dialog.show(given.name);
  }

  private aboutText(): string {
    const { A, B, C, period } = this.given;
    const here = this.bench.data.period;
    const made = period === null ? `continuous, discretised by Tustin's rule, Ts = ${here} s` : `discrete, Ts = ${here} s`;
    const fast = period === null ? eigenvalues(A).filter(({ real, imaginary }) => Math.hypot(real, imaginary) * here > Math.PI).length : 0;
    const told = fast ? ` ${countText(fast, "pole")} of it beyond half the sampling rate: discretised, it differs there.` : "";
    return `${countText(A.rows, "state")}, ${countText(B.columns, "input")}, ${countText(C.rows, "output")}; ${made}. ${polesText(ratesOf(A, period))}${told}`;
  }

  /** Where the file can go: where it is already, else where nothing is; else the reader says what makes room. */
  private get law(): MatricesLaw | undefined {
    const { laws, bench, given } = this;
    const own = laws.find(({ controller }) => bench.held(controller)?.split(", ")[0] === given.name);
    return own ?? laws.find(({ controller }) => bench.held(controller) === undefined) ?? laws[this.room.selectedIndex - 1];
  }

  private askForRoom(): void {
    this.room.replaceChildren(element("option", "", "choose…"));
    this.roomAsked.hidden = this.law !== undefined;
    this.room.append(...this.laws.map(({ controller }) => element("option", "", this.bench.held(controller) ?? "")));
  }

  private get measured(): string[] {
    return this.inputs.map((each) => this.bench.data.controlled[each.selectedIndex]!);
  }

  private get moved(): string[] {
    return this.outputs.map((each) => this.bench.data.inputs[each.selectedIndex]!);
  }

  private askUnits(): void {
    const { signals, laws } = this.bench;
    const asked = (names: string[]) => names.map((name) => ({ signal: signals.get(name)!, percent: laws.percent[name], others: laws.units[name] ?? [] }));
    this.inputUnits.ask(asked(this.measured));
    this.outputUnits.ask(asked(this.moved));
  }

  /** Tell what follows from the answers, or what is still to be answered. */
  private answer(): void {
    const found = this.missing() ?? this.computed();
    this.found = typeof found === "string" ? null : found;
    if (typeof found === "string") this.told.replaceChildren(element("p", "note", found));
    else {
      const look = "the units, the sign and the order of the signals";
      this.told.replaceChildren(this.responses(found.system), ...marginsTold(found.margins, look), ...(found.told ? [] : [element("p", "watch", NO_OBSERVER)]));
    }
    this.bumpless.disabled = !this.found?.told;
    this.zero.disabled = !this.found;
  }

  private responses(system: SampledSystem): HTMLElement {
    const { data, signals } = this.bench;
    const shown = (names: string[]): ShownSignal[] => names.map((name) => signals.get(name)!);
    return errorResponsesTold(system, shown(this.measured), shown(this.moved), data.period);
  }

  private missing(): string | null {
    const { measured, moved } = this;
    if (new Set(measured).size < measured.length) return "Two of its inputs are the error of the same signal: choose another one.";
    if (new Set(moved).size < moved.length) return "Two of its outputs move the same input: choose another one.";
    const wrong = this.inputUnits.wrong ?? this.outputUnits.wrong;
    if (wrong) return `${wrong}.`;
    const open = [
      ...(this.inputUnits.scales ? [] : ["in which unit its inputs are"]),
      ...(this.outputUnits.scales ? [] : ["in which unit its outputs are"]),
      ...(this.sign.selectedIndex ? [] : ["which way round its inputs are"]),
      ...(this.law ? [] : ["which controller it replaces"]),
    ];
    return open.length ? `Say ${open.join(", and ")}. Margins appear here.` : null;
  }

  private computed(): Found {
    const { data, plants, signals } = this.bench;
    const { measured, moved } = this;
    const [, sign] = SIGNS[this.sign.selectedIndex - 1]!;
    const system = inSi(this.sampled, this.inputUnits.scales!, this.outputUnits.scales!, sign);
    const spans = (names: string[]): number[] => names.map((name) => spanOf(signals.get(name)!));
    const places = (names: string[], all: string[]): number[] => names.map((name) => all.indexOf(name));
    const whole = (of: typeof system) =>
      widened(of, places(measured, data.controlled), places(moved, data.inputs), { inputs: data.controlled.length, outputs: data.inputs.length });
    const plant = plants[this.laws[0]!.plant ?? -1];
    const told = toldByOwnObserver(system, spans(measured), spans(moved));
    return {
      told,
      deaf: unconditioned(system),
      system,
      margins: plant ? loopMargins(plant, whole(system), new Set([...measured, ...moved]), data.period) : null,
    };
  }

  private switchOn(start: "bumpless" | "zero"): void {
    const { bench, found, given } = this;
    const matrices = start === "zero" ? found!.deaf : found!.told!;
    const law = this.law!;
    const units = `${this.inputUnits.unitWords("input")}, ${this.outputUnits.unitWords("output")}, ${SIGNS[this.sign.selectedIndex - 1]![0].slice(0, 5)}`;
    const end = start === "zero" ? "from zero state, no anti-windup" : "anti-windup on";
    this.dialog.close();
    bench.switchOn({
      law,
      title: start === "zero" ? `${this.given.name}, from zero state` : this.given.name,
      words: `${units}; ${end}`,
      settings: { ...this.settings(law, matrices), ...this.biases(law, start) },
      moves: this.moved,
      start,
      again: () => this.openAgain(given),
    });
  }

  /** Ask about a regulator once more, with what was answered where it is still there. */
  private openAgain(given: GivenRegulator): void {
    if (this.given !== given) return this.open(given);
    this.askForRoom();
    this.answer();
    this.dialog.show(given.name);
  }

  /** Return the numbers of the law by name; what the matrices do not fill is zero. */
  private settings(law: MatricesLaw, { transition, entered, told, shown, direct }: ConditionedMatrices): Record<string, number> {
    const { data } = this.bench;
    const names = lawParameters(data, law.controller).map(([name]) => name);
    const values = names.map((): number | undefined => undefined);
    const [inputs, outputs] = [this.measured.map((name) => data.controlled.indexOf(name)), this.moved.map((name) => data.inputs.indexOf(name))];
    const states = Array.from({ length: transition.rows }, (_, state) => state);
    const { states: n } = law;
    const fill = (places: number[], columns: number, of: typeof told, to: number[], by: number[]): void => {
      for (const place of places) values[place] = 0;
      of.values.forEach((value, each) => {
        const [row, column] = [to[Math.floor(each / of.columns)]!, by[each % of.columns]!];
        values[places[row * columns + column]!] = value;
      });
    };
    fill(law.places.transition, n, transition, states, states);
    fill(law.places.error_effect, data.controlled.length, entered, states, inputs);
    fill(law.places.output_effect, data.inputs.length, told, states, outputs);
    fill(law.places.memory_gain, n, shown, outputs, states);
    fill(law.places.error_gain, data.controlled.length, direct, outputs, inputs);
    const fading = this.fadingTime();
    if (fading !== null) for (const place of law.fading) values[place] = fading;
    return Object.fromEntries(names.flatMap((name, place) => (values[place] === undefined ? [] : [[name, values[place]]])));
  }

  /** Return what its outputs are without an error: those at rest; from zero state there are none. */
  private biases(law: MatricesLaw, start: "bumpless" | "zero"): Record<string, number> {
    const own = new Set(this.bench.data.inputs.map((name) => `controller.${name}.bias`));
    const found = lawParameters(this.bench.data, law.controller).filter(([name]) => own.has(name));
    return Object.fromEntries(found.map(([name, value]) => [name, start === "zero" ? 0 : value]));
  }

  /** Return how fast what a start adds to the outputs goes away [s]: as fast as the loop is. */
  private fadingTime(): number | null {
    const crossovers = this.found!.margins?.margins.map(({ crossover }) => crossover).filter((each) => each > 0) ?? [];
    return crossovers.length ? Math.max(1 / Math.min(...crossovers), this.bench.data.period) : null;
  }
}

function countText(number: number, word: string): string {
  return `${number} ${word}${number === 1 ? "" : "s"}`;
}
