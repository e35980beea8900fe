const DESCRIPTION = null;

const PAGE = 65536;
const NUMBER = 8;

/**
 * Make an instance of the module.
 *
 * @param {BufferSource|WebAssembly.Module} source The content of the .wasm file, or it compiled.
 * @returns {Promise<Instance>} At its initial state, with every input and parameter as printed.
 */
export async function instantiate(source) {
  const module = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(source);
  const memory = new WebAssembly.Memory({ initial: 1 });
  const instance = await WebAssembly.instantiate(module, { env: { memory } });
  return new Instance(instance.exports, memory);
}

/** The signals, in the order of their memory: names, units, kinds and initial values. */
export const signals = DESCRIPTION;

class Instance {
  #exports;
  #memory;
  #places = {};

  constructor(exports, memory) {
    this.#exports = exports;
    this.#memory = memory;
    const ringed = DESCRIPTION.rings.reduce((sum, ring) => sum + ring.length, 0);
    let end = exports.heap.value;
    for (const [group, count] of [
      ...["state", "parameters", "inputs", "outputs"].map((name) => [name, DESCRIPTION[name].length]),
      ["rings", ringed],
    ]) {
      this.#places[group] = [end, count];
      end += NUMBER * count;
    }
    const missing = Math.ceil(end / PAGE) - memory.buffer.byteLength / PAGE;
    if (missing > 0) memory.grow(missing);
    /** What the next step reads, by name; a name that is not there cannot be set. */
    this.inputs = Object.seal(initial(DESCRIPTION.inputs));
    this.parameters = Object.seal(initial(DESCRIPTION.parameters));
    this.initialise();
  }

  /** Go back to the initial state. */
  initialise() {
    this.#view("state").set(DESCRIPTION.state.map((signal) => signal.initial));
    const rings = this.#view("rings");
    for (const [ring, first, last] of places()) rings.fill(ring.initial, first, last);
  }

  /** Compute one sample and return its outputs by name. */
  step() {
    this.#write("inputs", this.inputs);
    this.#write("parameters", this.parameters);
    const [state, parameters, inputs, outputs, rings] = [
      "state", "parameters", "inputs", "outputs", "rings",
    ].map((name) => this.#places[name][0]);
    this.#exports.clepsydra_kernel(
      state, parameters, inputs, inputs, outputs, rings, 1n, 1n, 1n, 1n,
    );
    this.#follow();
    const values = this.#view("outputs");
    return Object.fromEntries(
      DESCRIPTION.outputs.map(({ name, kind }, place) => [
        name, kind === "boolean" ? values[place] !== 0 : values[place],
      ]),
    );
  }

  /** Everything that lives from sample to sample: set later, it goes on from there. */
  get state() {
    return { values: this.#view("state").slice(), rings: this.#view("rings").slice() };
  }

  set state({ values, rings }) {
    this.#view("state").set(checked(values, DESCRIPTION.state.length));
    this.#view("rings").set(checked(rings, this.#places.rings[1]));
  }

  // Memory that the kernel takes for itself leaves older views without a buffer.
  #view(group) {
    return new Float64Array(this.#memory.buffer, ...this.#places[group]);
  }

  #write(group, values) {
    this.#view(group).set(
      DESCRIPTION[group].map(({ name }) => {
        const value = Number(values[name]);
        if (Number.isNaN(value) && !Number.isNaN(values[name])) {
          throw new TypeError(`${group}.${name}: expected a number, got ${typeof values[name]}`);
        }
        return value;
      }),
    );
  }

  /** The oldest entry of each ring stands first, as the kernel takes it. */
  #follow() {
    const rings = this.#view("rings");
    for (const [ring, first, last] of places()) {
      const turned = ring.turns % ring.length;
      const part = rings.slice(first, last);
      rings.set(part.subarray(turned), first);
      rings.set(part.subarray(0, turned), last - turned);
    }
  }
}

function initial(listed) {
  return Object.fromEntries(listed.map((signal) => [signal.name, signal.initial]));
}

function* places() {
  let first = 0;
  for (const ring of DESCRIPTION.rings) {
    yield [ring, first, first + ring.length];
    first += ring.length;
  }
}

function checked(values, count) {
  if (values.length !== count) {
    throw new RangeError(`state: expected ${count} numbers, got ${values.length}`);
  }
  return values;
}
