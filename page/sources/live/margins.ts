/** Margins of each channel of a sampled loop broken alone: `loop_response.py` and `channel.py`. */

import { type Complex, complex, returnDifference, solve } from "./complex.ts";
import type { Eigenvalue } from "./eigenvalues.ts";
import type { Plant } from "./linear_loop.ts";
import type { ChannelMargins, SampledPlant } from "./messages.ts";
import { Response, type SampledSystem } from "./response.ts";

const PER_DECADE = 60;
/** Beside half the sampling frequency, what is slower than this stands still. */
const SLOWEST = 1e-9;
/** A range of frequencies below the slowest mode of the loop, and below that nothing happens. */
const BELOW = 30;
/** Around a resonance, in units of its half-width. */
const AROUND = [-4, -2, -1, -0.5, 0, 0.5, 1, 2, 4];
/** An imaginary part below this share is rounding: half way round the circle L is real. */
const ROUNDING = 1e-9;

/** L(e^jωT) of one channel while the others stay closed. */
interface Channel {
  name: string;
  real: number[];
  imaginary: number[];
}

export function marginsOf(
  plant: Plant, names: SampledPlant, law: SampledSystem, poles: Eigenvalue[], period: number,
): ChannelMargins[] {
  const frequencies = frequenciesOf(poles, period);
  const channels = channelsOf(plant, names, law, frequencies.map((each) => each * period));
  return channels.map((channel) => marginsOfChannel(channel, frequencies));
}

/** Return frequencies that show all that a loop does, up to half the sampling frequency. */
function frequenciesOf(poles: Eigenvalue[], period: number): number[] {
  const fastest = Math.PI / period;
  const rates = poles
    .map(({ real, imaginary }) => ({ size: Math.hypot(real, imaginary), angle: Math.atan2(imaginary, real) }))
    .filter(({ size }) => size > 1e-6)
    .map(({ size, angle }) => ({ real: Math.log(size) / period, imaginary: angle / period }));
  const sizes = rates.map(({ real, imaginary }) => Math.hypot(real, imaginary));
  const slowest = Math.min(fastest, ...sizes.filter((size) => size > SLOWEST * fastest)) / BELOW;
  const decades = Math.log10(fastest / slowest);
  const count = Math.ceil(PER_DECADE * decades);
  const grid = Array.from({ length: count }, (_, place) => slowest * 10 ** ((decades * place) / count));
  const around = rates
    .filter(({ real, imaginary }) => imaginary > 0 && Math.abs(real) < 0.3 * imaginary)
    .flatMap(({ real, imaginary }) => AROUND.map((share) => imaginary + Math.abs(real) * share))
    .filter((frequency) => frequency > slowest && frequency < fastest);
  return [...new Set([...grid, ...around, fastest])].sort((one, other) => one - other);
}

/** Return the channels: controlled measurements, those of inner loops, manipulated variables. */
function channelsOf(
  plant: Plant, names: SampledPlant, law: SampledSystem, angles: number[],
): Channel[] {
  const { measurements, manipulated } = names;
  // A setpoint whose measurement the law does not read closes no loop.
  const outputs = names.controlled.filter((name) => measurements.includes(name));
  const broken = [...outputs, ...names.inner.filter((name) => !outputs.includes(name))];
  const channels = [...broken, ...manipulated].map((name): Channel => ({ name, real: [], imaginary: [] }));
  const feedback = new Response(law);
  for (const angle of angles) {
    const z = { real: Math.cos(angle), imaginary: Math.sin(angle) };
    const [process, back] = [plant.response.at(z), feedback.at(z)];
    // A measurement that the law reads twice is disturbed in both places at once.
    const atSensors = complex(measurements.length, broken.length);
    measurements.forEach((name, row) =>
      broken.forEach((other, column) => {
        if (name === other) atSensors.real[row * broken.length + column] = 1;
      }),
    );
    solve(returnDifference(process, back), atSensors);
    broken.forEach((name, column) => {
      addTo(channels[column]!, atSensors, measurements.indexOf(name) * broken.length + column);
    });
    const m = manipulated.length;
    const atInputs = complex(m, m);
    for (let each = 0; each < m; ++each) atInputs.real[each * m + each] = 1;
    solve(returnDifference(back, process), atInputs);
    for (let each = 0; each < m; ++each) addTo(channels[broken.length + each]!, atInputs, each * m + each);
  }
  return channels;
}

/** Add L = 1/S − 1 at a frequency, of an entry of S. */
function addTo(channel: Channel, of: Complex, place: number): void {
  const [real, imaginary] = [of.real[place]!, of.imaginary[place]!];
  const square = real * real + imaginary * imaginary;
  channel.real.push(real / square - 1);
  channel.imaginary.push(-imaginary / square);
}

function marginsOfChannel({ name, real, imaginary }: Channel, frequencies: number[]): ChannelMargins {
  const sizes = real.map((each, place) => Math.log(Math.max(Math.hypot(each, imaginary[place]!), 1e-300)));
  const crossings = zerosOf(sizes);
  const crossovers = crossings.of(frequencies.map(Math.log)).map(Math.exp);
  const angles = unwrapped(real.map((each, place) => Math.atan2(-imaginary[place]!, -each)));
  let [phase, crossover] = [Infinity, NaN];
  crossings.of(angles).forEach((angle, place) => {
    const turned = Math.abs(Math.atan2(Math.sin(angle), Math.cos(angle)));
    if (turned < phase) [phase, crossover] = [turned, crossovers[place]!];
  });
  return {
    name,
    gain: gainMargin(real, imaginary),
    phase: (phase * 180) / Math.PI,
    crossover,
    delay: Number.isFinite(phase) && crossover > 0 ? phase / crossover : Infinity,
    peak: Math.max(...real.map((each, place) => 1 / Math.hypot(1 + each, imaginary[place]!))),
  };
}

/** Return the factor nearest to one that puts L through −1. */
function gainMargin(real: number[], imaginary: number[]): number {
  const across = imaginary.map((each, place) =>
    Math.abs(each) <= ROUNDING * Math.hypot(real[place]!, each) ? 0 : each,
  );
  const found = zerosOf(across).of(real);
  if (across.at(-1) === 0) found.push(real.at(-1)!);
  const margins = found.filter((each) => each < 0).map((each) => -1 / each);
  const distance = (margin: number): number => Math.abs(Math.log(margin));
  return margins.reduce((best, each) => (distance(each) < distance(best) ? each : best), Infinity);
}

/** Return what tells values where a function of the same grid changes its sign, by straight lines. */
function zerosOf(values: number[]): { of(others: number[]): number[] } {
  const found: [place: number, share: number][] = [];
  for (let place = 0; place + 1 < values.length; ++place) {
    const [left, right] = [values[place]!, values[place + 1]!];
    if (left * right < 0) found.push([place, left / (left - right)]);
  }
  return {
    of: (others) =>
      found.map(([place, share]) => others[place]! + share * (others[place + 1]! - others[place]!)),
  };
}

/** Return angles without jumps of whole turns. */
function unwrapped(angles: number[]): number[] {
  let turns = 0;
  return angles.map((angle, place) => {
    const step = angle - (place ? angles[place - 1]! : angle);
    if (step > Math.PI) turns -= 1;
    else if (step < -Math.PI) turns += 1;
    return angle + 2 * Math.PI * turns;
  });
}
