/** What every loop of a report is given: setpoints, disturbances, noise, and what its scores are told. */

import { unpackedNumbers } from "./bytes.ts";
import type { InputColumn, LiveData } from "./messages.ts";
import { whiteNoise } from "./noise.ts";

/** Return the inputs of a run row by row [samples × inputs]. */
export async function inputsOf({ inputs, samples }: LiveData): Promise<Float64Array> {
  const rows = new Float64Array(samples * inputs.length);
  const columns = await Promise.all(inputs.map((column) => columnOf(column, samples)));
  columns.forEach((values, place) => {
    values.forEach((value, sample) => (rows[sample * inputs.length + place] = value));
  });
  return rows;
}

async function columnOf({ packed, constant, noise }: InputColumn, samples: number): Promise<Float64Array> {
  const values = packed === null ? new Float64Array(samples).fill(constant) : await unpackedNumbers(packed);
  if (noise) whiteNoise(noise).forEach((value, place) => (values[noise.first + place]! += value));
  return values;
}
