/** What signals were, sample by sample, as far back as there is room. */

const CHUNK = 8192;
/** Samples that are kept at least. */
const CAPACITY = 1 << 20;

export class History {
  readonly names: readonly string[];
  readonly capacity: number;
  /** The first sample that is kept, and the one behind the last. */
  first: number;
  count: number;
  /** The sample with which the first chunk begins. */
  private start: number;
  /** Each signal's part of a chunk lies behind that of the one before. */
  private chunks: Float64Array[] = [];
  private readonly places: Map<string, number>;

  /** @param first The sample with which it begins. */
  constructor(names: readonly string[], capacity = CAPACITY, first = 0) {
    this.names = names;
    this.capacity = capacity;
    this.first = this.count = first;
    this.start = first - (first % CHUNK);
    this.places = new Map(names.map((name, place) => [name, place]));
  }

  /** Add a sample, of which a function tells each column. */
  add(value: (column: number) => number): void {
    const place = this.count % CHUNK;
    if (place === 0 || !this.chunks.length) {
      this.chunks.push(new Float64Array(CHUNK * this.names.length));
      if ((this.chunks.length - 1) * CHUNK > this.capacity) {
        this.chunks.shift();
        this.start += CHUNK;
        this.first = this.start;
      }
    }
    const chunk = this.chunks.at(-1)!;
    for (let column = 0; column < this.names.length; ++column) chunk[column * CHUNK + place] = value(column);
    this.count += 1;
  }

  /** Return a signal at a sample; NaN where nothing is kept. */
  value(name: string, sample: number): number {
    const column = this.places.get(name);
    if (column === undefined || sample < this.first || sample >= this.count) return NaN;
    return this.chunks[Math.floor((sample - this.start) / CHUNK)]![column * CHUNK + (sample % CHUNK)]!;
  }

  /** Return the values of a signal from a sample to before another; NaN where nothing is kept. */
  values(name: string, from: number, to: number): Float64Array {
    const found = new Float64Array(Math.max(0, to - from)).fill(NaN);
    const column = this.places.get(name);
    if (column === undefined) return found;
    const stop = Math.min(to, this.count);
    for (let sample = Math.max(from, this.first); sample < stop; ) {
      const place = sample % CHUNK;
      const length = Math.min(CHUNK - place, stop - sample);
      const start = column * CHUNK + place;
      found.set(this.chunks[Math.floor((sample - this.start) / CHUNK)]!.subarray(start, start + length), sample - from);
      sample += length;
    }
    return found;
  }

  /** Return the same past up to a sample; what is whole is shared, and never changes. */
  fork(count: number): History {
    const other = new History(this.names, this.capacity);
    other.first = this.first;
    other.start = this.start;
    other.count = count;
    const chunks = Math.ceil((count - this.start) / CHUNK);
    other.chunks = this.chunks.slice(0, chunks);
    if (count % CHUNK) other.chunks[chunks - 1] = other.chunks[chunks - 1]!.slice();
    return other;
  }
}
