const read = (text) =>
  new Float64Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
const written = (numbers) =>
  btoa(Array.from(new Uint8Array(numbers.buffer), (byte) => String.fromCharCode(byte)).join(""));

/**
 * Go through scans of an exported program; before some its state is taken out, the run spoilt by
 * further steps, and the state put back, into another instance or after a fresh start too.
 * Numbers are the bytes of doubles in base 64, a scan behind the other.
 */
export async function called({ instantiate, signals }, module, given) {
  const rows = read(given.inputs), parameters = read(given.parameters);
  const begun = async () => {
    const fresh = await instantiate(module);
    signals.parameters.forEach(({ name }, place) => { fresh.parameters[name] = parameters[place]; });
    return fresh;
  };
  const found = new Float64Array(given.scans * signals.outputs.length);
  let one = await begun();
  for (let scan = 0; scan < given.scans; ++scan) {
    if (given.broken.includes(scan)) {
      const kept = one.state;
      for (let more = 0; more < 7; ++more) one.step();
      if (scan % 3 === 0) one = await begun();
      if (scan % 3 === 1) one.initialise();
      one.state = kept;
    }
    signals.inputs.forEach(({ name, kind }, place) => {
      const value = rows[scan * signals.inputs.length + place];
      one.inputs[name] = kind === "boolean" ? value !== 0 : value;
    });
    found.set(Object.values(one.step()).map(Number), scan * signals.outputs.length);
  }
  return written(found);
}
