/** A run of the rig as a lesson looks at it: what it recorded, and what hands had set at each sample. */

import type { Touch } from "./data.ts";
import type { Rig } from "./rig.ts";
import type { Run } from "./run.ts";
import type { SeenRun } from "./watched.ts";

/** From which sample on something had which value. */
interface Changes<Value> {
  samples: number[];
  values: Value[];
}

export class SeenRunOfRig implements SeenRun {
  readonly identity: Run;
  readonly parent: Run | undefined;
  readonly count: number;
  private readonly rig: Rig;
  private readonly touches: readonly Touch[];
  private readonly changes = new Map<string, Changes<number>>();
  private readonly takeovers: Changes<string>;

  constructor(rig: Rig) {
    this.rig = rig;
    this.identity = rig.run;
    this.parent = rig.run.parent;
    this.count = rig.sample;
    this.touches = rig.run.touches;
    this.takeovers = collected(this.touches, rig.data.controllers[0]!.name, (touch) => ("controller" in touch ? touch.controller : undefined));
  }

  value(name: string, sample: number): number {
    const { history } = this.identity;
    return history.names.includes(name) ? history.value(name, sample) : at(this.changesOf(name), sample);
  }

  controller(sample: number): string {
    return at(this.takeovers, sample);
  }

  private changesOf(name: string): Changes<number> {
    let found = this.changes.get(name);
    if (!found) {
      const { parameters, controllers } = this.rig.data;
      const before = parameters.find((each) => each.name === name)?.value ?? controllers[0]!.inputs.find(([each]) => each === name)?.[1] ?? NaN;
      found = collected(this.touches, before, (touch) => {
        if ("input" in touch) return touch.input === name ? touch.value : undefined;
        return "parameters" in touch ? touch.parameters[name] : undefined;
      });
      this.changes.set(name, found);
    }
    return found;
  }
}

function collected<Value>(touches: readonly Touch[], before: Value, told: (touch: Touch) => Value | undefined): Changes<Value> {
  const found: Changes<Value> = { samples: [0], values: [before] };
  for (const touch of touches) {
    const value = told(touch);
    if (value === undefined) continue;
    found.samples.push(touch.sample);
    found.values.push(value);
  }
  return found;
}

/** Return what held at a sample: the last that was set before it or for it. */
function at<Value>({ samples, values }: Changes<Value>, sample: number): Value {
  let [low, high] = [0, samples.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (samples[middle]! <= sample) low = middle;
    else high = middle;
  }
  return values[low]!;
}
