/**
 * The variables of a MAT file of version 4, 6 or 7, of which only small matrices of numbers are read,
 * as `designs/regulators/mat_variables.py` reads them.
 *
 * MAT-File Format, The MathWorks, versions 4 and 5, which 6 and 7 write too.
 */

/** A variable; one without numbers is no small matrix of numbers. */
export interface Variable {
  /** Its class: "double", "struct". */
  kind: string;
  shape: number[];
  /** Column by column. */
  numbers: Float64Array | null;
  isComplex: boolean;
}

/** What is no MAT file of these versions, or damaged. */
export class Damaged extends Error {}

const MOST_VARIABLES = 1000;
const LONGEST_NAME = 63;
/** So much of a compressed variable is looked at: a hundred by a hundred doubles and its name. */
const LOOKED_AT = 100_000;
const HEADER = 128;
const [MATRIX, COMPRESSED, COMPLEX] = [14, 15, 0x800];
const [FIRST_NUMBERS, LAST_NUMBERS, OPAQUE] = [6, 15, 17];
const CLASSES = [
  "", "cell", "struct", "object", "char", "sparse", "double", "single", "int8", "uint8", "int16",
  "uint16", "int32", "uint32", "int64", "uint64", "function", "object",
];

interface Stored {
  size: number;
  at(view: DataView, place: number, little: boolean): number;
}

/** How numbers are stored, which may be smaller than their class. */
const INT8: Stored = { size: 1, at: (view, place) => view.getInt8(place) };
const UINT8: Stored = { size: 1, at: (view, place) => view.getUint8(place) };
const INT16: Stored = { size: 2, at: (view, place, little) => view.getInt16(place, little) };
const UINT16: Stored = { size: 2, at: (view, place, little) => view.getUint16(place, little) };
const INT32: Stored = { size: 4, at: (view, place, little) => view.getInt32(place, little) };
const UINT32: Stored = { size: 4, at: (view, place, little) => view.getUint32(place, little) };
const SINGLE: Stored = { size: 4, at: (view, place, little) => view.getFloat32(place, little) };
const DOUBLE: Stored = { size: 8, at: (view, place, little) => view.getFloat64(place, little) };
const INT64: Stored = { size: 8, at: (view, place, little) => Number(view.getBigInt64(place, little)) };
const UINT64: Stored = { size: 8, at: (view, place, little) => Number(view.getBigUint64(place, little)) };
const STORED = new Map([
  [1, INT8], [2, UINT8], [3, INT16], [4, UINT16], [5, INT32], [6, UINT32], [7, SINGLE], [9, DOUBLE], [12, INT64], [13, UINT64],
]);
const STORED_BEFORE = [DOUBLE, SINGLE, INT32, INT16, UINT16, UINT8];

/** Return the variables of a MAT file by name; of matrices up to `most` rows and columns the numbers. */
export async function matVariables(content: Uint8Array, most: number): Promise<Map<string, Variable>> {
  const found = new Map<string, Variable>();
  try {
    const variables = content.subarray(0, 4).includes(0) ? oldVariables(content, most) : newVariables(content, most);
    for await (const [name, variable] of variables) {
      found.set(name, variable);
      if (found.size > MOST_VARIABLES) break;
    }
  } catch (error) {
    // Beyond the end of what there is, or no deflated bytes.
    if (error instanceof RangeError || error instanceof TypeError) throw new Damaged(error.message);
    throw error;
  }
  return found;
}

async function* newVariables(content: Uint8Array, most: number): AsyncGenerator<[string, Variable]> {
  const view = viewOf(content);
  const order = text(content.subarray(HEADER - 2, HEADER));
  if (order !== "IM" && order !== "MI") throw new Damaged("no header of a MAT file");
  const little = order === "IM";
  if (view.getUint16(HEADER - 4, little) !== 0x100) throw new Damaged("no header of a MAT file");
  for (let place = HEADER; place < content.length; ) {
    let [kind, size] = [view.getUint32(place, little), view.getUint32(place + 4, little)];
    let data = content.subarray(place + 8, place + 8 + size);
    if (data.length < size) throw new Damaged("the file ends inside a variable");
    place += 8 + size;
    if (kind === COMPRESSED) {
      const whole = await inflated(data);
      [kind, size] = [viewOf(whole).getUint32(0, little), viewOf(whole).getUint32(4, little)];
      data = whole.subarray(8, 8 + size);
    }
    if (kind === MATRIX) yield matrixOf(data, little, most);
  }
}

function matrixOf(data: Uint8Array, little: boolean, most: number): [string, Variable] {
  const flags = element(data, little, 0);
  const flag = viewOf(flags.content).getUint32(0, little);
  const known = flag & 0xff;
  const kind = CLASSES[known] ?? "unknown";
  // An object has its name in the place of its size.
  if (known === OPAQUE) return [nameOf(element(data, little, flags.end).content), { kind, shape: [], numbers: null, isComplex: false }];
  const sizes = element(data, little, flags.end);
  const sizeView = viewOf(sizes.content);
  const shape = Array.from({ length: sizes.content.length >> 2 }, (_, each) => sizeView.getInt32(4 * each, little));
  const called = element(data, little, sizes.end);
  const name = nameOf(called.content);
  const isComplex = (flag & COMPLEX) !== 0;
  const isSmall = shape.length === 2 && shape.every((size) => size >= 0 && size <= most);
  if (known < FIRST_NUMBERS || known > LAST_NUMBERS || !isSmall) return [name, { kind, shape, numbers: null, isComplex }];
  const stored = element(data, little, called.end);
  const by = STORED.get(stored.kind);
  if (!by) throw new Damaged("numbers that are stored in no known way");
  return [name, { kind, shape, numbers: numbersOf(stored.content, by, shape, little), isComplex }];
}

/** Return an element of a variable: its type, its content and where the next one begins. */
function element(data: Uint8Array, little: boolean, place: number): { kind: number; content: Uint8Array; end: number } {
  const view = viewOf(data);
  let [kind, size] = [view.getUint32(place, little), view.getUint32(place + 4, little)];
  let [start, end] = [place + 8, place + 8 + size + ((8 - (size % 8)) % 8)];
  if (kind >>> 16) {
    // Up to four bytes stand beside the tag.
    [kind, size] = [kind & 0xffff, kind >>> 16];
    [start, end] = [place + 4, place + 8];
    if (size > 4) throw new Damaged("an element that is larger than its place");
  }
  const content = data.subarray(start, start + size);
  if (content.length < size) throw new Damaged("the file ends inside an element");
  return { kind, content, end };
}

function numbersOf(stored: Uint8Array, { size, at }: Stored, shape: number[], little: boolean): Float64Array {
  const count = shape.reduce((product, each) => product * each, 1);
  if (stored.length !== count * size) throw new Damaged("as many numbers as the matrix does not have");
  const view = viewOf(stored);
  return Float64Array.from({ length: count }, (_, place) => at(view, place * size, little));
}

function* oldVariables(content: Uint8Array, most: number): Generator<[string, Variable]> {
  const view = viewOf(content);
  for (let place = 0; place < content.length; ) {
    const little = view.getUint32(place, true) < 10_000;
    const [code, rows, columns, imaginary, length] = [0, 4, 8, 12, 16].map((each) => view.getInt32(place + each, little)) as [number, number, number, number, number];
    const machine = Math.floor(code / 1000);
    const by = STORED_BEFORE[Math.floor(code / 10) % 10];
    if ((machine !== 0 && machine !== 1) || Math.floor(code / 100) % 10 || !by) throw new Damaged("no header of a variable of version 4");
    if (Math.min(rows, columns) < 0 || length < 1 || length > LONGEST_NAME + 1) throw new Damaged("a variable of no size or name");
    const begins = place + 20 + length;
    const name = nameOf(content.subarray(place + 20, begins)).replace(/\0+$/, "");
    const size = rows * columns * by.size;
    place = begins + size * (imaginary ? 2 : 1);
    if (place > content.length) throw new Damaged("the file ends inside a variable");
    const kind = ["double", "char", "sparse"][code % 10] ?? "unknown";
    const isRead = kind === "double" && Math.max(rows, columns) <= most;
    const numbers = isRead ? numbersOf(content.subarray(begins, begins + size), by, [rows, columns], little) : null;
    yield [name, { kind, shape: [rows, columns], numbers, isComplex: imaginary !== 0 }];
  }
}

/** Return the first bytes of what was deflated. */
async function inflated(data: Uint8Array): Promise<Uint8Array> {
  const stream = new Blob([data as BlobPart]).stream().pipeThrough(new DecompressionStream("deflate"));
  const reader = stream.getReader();
  const parts: Uint8Array[] = [];
  for (let size = 0; size < LOOKED_AT; ) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    size += value.length;
  }
  // What comes later is not looked at, whatever it is.
  reader.cancel().catch(() => undefined);
  const whole = new Uint8Array(parts.reduce((size, part) => size + part.length, 0));
  let place = 0;
  for (const part of parts) {
    whole.set(part, place);
    place += part.length;
  }
  return whole.subarray(0, LOOKED_AT);
}

function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

function text(bytes: Uint8Array): string {
  return String.fromCharCode(...bytes);
}

function nameOf(bytes: Uint8Array): string {
  if (bytes.some((each) => each > 127)) throw new Damaged("a name that is no text");
  return text(bytes);
}
