/**
 * MAT files of version 5, which MATLAB, Octave and SciPy read: columns of numbers, and rows of text.
 *
 * MAT-File Format, The MathWorks, version 5 (R2006b and later): a header of 128 bytes, then one
 * element for each variable, whose parts are padded to 8 bytes.
 */

/** Numbers as a column, or texts as the rows of a matrix of characters. */
export type MatVariable = { name: string; values: Float64Array } | { name: string; rows: string[] };

const HEADER = 128;
const [INT8, INT32, UINT16, UINT32, DOUBLE, MATRIX] = [1, 5, 4, 6, 9, 14];
const [CHARACTER_CLASS, DOUBLE_CLASS] = [4, 6];
const WORDS = "MATLAB 5.0 MAT-file, written by Clepsydra";
const VERSION = 0x0100;
/** "IM" in the order of bytes that the file has. */
const LITTLE_ENDIAN = 0x4d49;

export function matFile(variables: MatVariable[]): Uint8Array<ArrayBuffer> {
  const bodies = variables.map(body);
  const found = new Uint8Array(HEADER + bodies.reduce((sum, each) => sum + 8 + each.length, 0));
  const view = new DataView(found.buffer);
  found.fill(0x20, 0, 116);
  found.set(new TextEncoder().encode(WORDS));
  view.setUint16(124, VERSION, true);
  view.setUint16(126, LITTLE_ENDIAN, true);
  let at = HEADER;
  for (const each of bodies) {
    view.setUint32(at, MATRIX, true);
    view.setUint32(at + 4, each.length, true);
    found.set(each, at + 8);
    at += 8 + each.length;
  }
  return found;
}

function body(variable: MatVariable): Uint8Array {
  const name = new TextEncoder().encode(variable.name);
  if ("values" in variable)
    return joined([flags(DOUBLE_CLASS), size(variable.values.length, 1), part(INT8, name), part(DOUBLE, bytes(variable.values))]);
  const width = Math.max(...variable.rows.map((row) => row.length));
  const letters = new Uint16Array(width * variable.rows.length).fill(0x20);
  // Column after column, as all matrices.
  variable.rows.forEach((row, line) => {
    for (let k = 0; k < row.length; ++k) letters[k * variable.rows.length + line] = row.charCodeAt(k);
  });
  return joined([flags(CHARACTER_CLASS), size(variable.rows.length, width), part(INT8, name), part(UINT16, bytes(letters))]);
}

const flags = (kind: number): Uint8Array => part(UINT32, bytes(Uint32Array.of(kind, 0)));
const size = (rows: number, columns: number): Uint8Array => part(INT32, bytes(Int32Array.of(rows, columns)));

/** Return an element: its type, how many bytes it has, and these. */
function part(type: number, content: Uint8Array): Uint8Array {
  const found = new Uint8Array(8 + 8 * Math.ceil(content.length / 8));
  const view = new DataView(found.buffer);
  view.setUint32(0, type, true);
  view.setUint32(4, content.length, true);
  found.set(content, 8);
  return found;
}

/** Return the bytes of numbers; every machine that has WebAssembly puts the least first. */
const bytes = ({ buffer, byteOffset, byteLength }: Float64Array | Uint32Array | Int32Array | Uint16Array): Uint8Array =>
  new Uint8Array(buffer as ArrayBuffer, byteOffset, byteLength);

function joined(parts: Uint8Array[]): Uint8Array {
  const found = new Uint8Array(parts.reduce((sum, each) => sum + each.length, 0));
  let at = 0;
  for (const each of parts) {
    found.set(each, at);
    at += each.length;
  }
  return found;
}
