/** A rig as its parts see and move it, whether it runs in the page or stands elsewhere. */

import type { PlantData } from "./data.ts";
import type { Run } from "./run.ts";

export interface SeenRig {
  readonly data: PlantData;
  readonly run: Run;
  /** Where it stands in the run: so many samples are over. */
  readonly sample: number;
  /** The controller that has it, or will have it in the next sample. */
  readonly controller: number;
  /** Set an input [SI] from the next sample on. */
  touch(input: string, value: number): void;
  /** Let sensors and noisy disturbances be noisy, or not. */
  noise(isOn: boolean): void;
  /** Let a sensor drift [SI/s]; 0 ends it. */
  drift(measurement: string, rate: number): void;
  /** Stand where the run stood after so many samples, at least one. */
  goTo(sample: number): void;
  /** Return an input or an output by name [SI], as hands have it where they set it. */
  value(name: string): number;
  /** Return what a hand has set an input to since the last sample [SI]; undefined where none has. */
  asked(input: string): number | undefined;
  /** Return a parameter of the process [SI]. */
  parameter(name: string): number;
  /** Return what comes out of the delays of the process [SI]. */
  delayed(): number[];
  /** Return what a sensor drifts by in a second [SI/s]. */
  drifting(measurement: string): number;
  /** Return a parameter of the law of a controller, as its program calls it [SI]. */
  setting(controller: number, name: string): number;
}
