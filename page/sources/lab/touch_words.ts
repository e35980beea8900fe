/** What hands did, in words. */

import { numberText } from "../words.ts";
import { port } from "./acknowledging.ts";
import type { PlantData, ShownSignal, Touch } from "./data.ts";
import { shownText } from "./quantities.ts";

/** A line of the log: touches of one key are one line. */
export interface TouchLine {
  key: string;
  words: string;
  isAbnormal: boolean;
  /** Whether a slider does it on and on, of which the last one counts. */
  isSlid: boolean;
}

type Told = (value: number, sample: number) => [words: string, isAbnormal?: boolean] | undefined;

/** Who moves a running rig, and what an instructor does to its wires. */
export const WIRES = {
  remote: "operator.remote", delay: "instructor.wire_delay", loss: "instructor.wire_loss", cut: "instructor.wire_cut",
};

const MODES = ["manual", "automatic", "tracking"];

export class TouchWords {
  private readonly inputs = new Map<string, { key: string; told: Told; isSlid?: boolean }>();
  private readonly parameters = new Map<string, Told>();

  private readonly titled: (controller: string) => string;

  /** @param titled Returns what a controller is called. */
  constructor(data: PlantData, titled: (controller: string) => string) {
    this.titled = titled;
    const signals = new Map(data.signals.map((each) => [each.name, each]));
    for (const name of data.controlled) this.setting(`${name}.setpoint`, `setpoint of ${name}`, signals.get(name)!);
    for (const name of data.inputs) this.actuator(name, signals.get(name)!);
    for (const name of data.measurements) this.sensor(name, signals.get(name)!);
    for (const name of data.disturbances) this.setting(name, name, signals.get(name)!);
    for (const alarm of data.alarms) {
      const input = port(alarm);
      this.inputs.set(input, { key: input, told: (is) => (is ? [`${alarm.words} acknowledged`] : undefined) });
    }
    this.wires();
    for (const signal of data.parameters) this.parameters.set(signal.name, (value) => [`${signal.name} to ${shownText(signal, value)}`]);
    for (const { tank, pour, full, samples, extra_outlet, outlets } of data.tanks) {
      let began = 0;
      this.inputs.set(pour, {
        key: pour, isSlid: true,
        told: (value, sample) => {
          if (value > 0) began = sample;
          const lasted = sample - began;
          const amount = `${volumeText(full * lasted * data.period)} (${numberText((25 * lasted) / samples, 3)} %)`;
          return [value > 0 ? `pouring into ${tank}` : `poured ${amount} into ${tank}`];
        },
      });
      this.parameters.set(extra_outlet, (value) => [`extra outlet of ${tank} ${value > 0 ? "opened" : "closed"}`]);
      for (const [outlet, parameter] of Object.entries(outlets)) {
        const told = this.parameters.get(parameter)!;
        this.parameters.set(parameter, (value, sample) => (value === 0 ? [`${outlet} plugged`] : told(value, sample)));
      }
    }
  }

  /** Return the lines that a touch makes: none where it only ends what another one began. */
  of({ sample, ...hand }: Touch): TouchLine[] {
    if ("input" in hand) {
      const found = this.inputs.get(hand.input);
      return line(found?.key ?? hand.input, found?.told(hand.value, sample), found?.isSlid);
    }
    if ("parameters" in hand)
      return Object.entries(hand.parameters).flatMap(([name, value]) => line(name, this.parameters.get(name)?.(value, sample)));
    if ("settings" in hand) return line(`settings ${hand.of}`, [`settings of ${this.titled(hand.of)} changed`], true);
    if ("controller" in hand) return line("controller", [`${this.titled(hand.controller)} is now in control${hand.start === "zero" ? ", from zero state" : ""}`]);
    if ("noise" in hand) return line("noise", [`noise ${hand.noise ? "on" : "off"}`]);
    return line(`${hand.drift}.fault`, hand.rate ? [`${hand.drift} drifts`, true] : [`${hand.drift} no longer drifts`]);
  }

  /** What is done to the wires of a running rig, and who moves it. */
  private wires(): void {
    const set = (input: string, told: Told): void => void this.inputs.set(input, { key: input, told });
    set(WIRES.remote, (is) => [is ? "the wires move the plant" : "the local panel moves the plant"]);
    set(WIRES.delay, (seconds) => (seconds ? [`wires answer ${numberText(seconds, 3)} s later`, true] : ["wires answer at once"]));
    set(WIRES.loss, (share) => (share ? [`wires lose ${numberText(100 * share, 3)} % of requests`, true] : ["wires lose nothing"]));
    set(WIRES.cut, (is) => (is ? ["cable pulled", true] : ["cable plugged in"]));
  }

  private setting(input: string, words: string, signal: ShownSignal): void {
    this.inputs.set(input, { key: input, told: (value) => [`${words} to ${shownText(signal, value)}`], isSlid: true });
  }

  private actuator(name: string, signal: ShownSignal): void {
    const fault = `${name}.fault`;
    this.setting(`${name}.manual`, `${name} by hand`, signal);
    this.inputs.set(`${name}.mode`, { key: `${name}.mode`, told: (mode) => [`${name} to ${MODES[mode] ?? mode}`] });
    this.inputs.set(`${name}.stopped`, { key: fault, told: (is) => (is ? [`${name} stopped`, true] : [`${name} runs again`]) });
    this.inputs.set(`${name}.stiction`, { key: fault, told: (band) => (band ? [`${name} sticks`, true] : [`${name} moves freely`]) });
  }

  private sensor(name: string, signal: ShownSignal): void {
    const fault = `${name}.fault`;
    let reading = NaN;
    this.inputs.set(`${name}.reading`, { key: fault, told: (value) => void (reading = value) });
    this.inputs.set(`${name}.forced`, {
      key: fault, told: (is) => (is ? [`${name} stuck at ${shownText(signal, reading)}`, true] : [`${name} OK again`]),
    });
    this.inputs.set(`${name}.sensor`, { key: fault, told: (is) => (is ? undefined : [`${name} dead`, true]) });
  }
}

function volumeText(volume: number): string {
  const [factor, unit] = volume < 1e-3 ? [1e6, "cm³"] : volume < 1 ? [1e3, "L"] : [1, "m³"];
  return `${numberText(factor * volume, 3)} ${unit}`;
}

function line(key: string, told: ReturnType<Told>, isSlid = false): TouchLine[] {
  return told ? [{ key, words: told[0], isAbnormal: told[1] ?? false, isSlid }] : [];
}
