/** Bytes and numbers that stand in the data as text. */

/** Return what base64 of zlib's deflate stands for. */
export async function unpacked(text: string): Promise<ArrayBuffer> {
  const deflated = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Return the numbers of a text, of 64 bits with the low ones first. */
export async function unpackedNumbers(text: string): Promise<Float64Array> {
  const bytes = new DataView(await unpacked(text));
  const count = bytes.byteLength / 8;
  return Float64Array.from({ length: count }, (_, place) => bytes.getFloat64(8 * place, true));
}
