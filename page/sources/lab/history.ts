/** What signals were, sample by sample, as far back as there is room. */

/** Samples that are kept. */
const CAPACITY = 100_000;

export class History {
  readonly names: string[];
  readonly capacity: number;
  private count = 0;
  private readonly columns: Float64Array[];

  constructor(names: string[], capacity = CAPACITY) {
    this.names = names;
    this.capacity = capacity;
    this.columns = names.map(() => new Float64Array(capacity));
  }

  clear(): void {
    this.count = 0;
  }

  add(value: (name: string) => number): void {
    const place = this.count % this.capacity;
    this.names.forEach((name, column) => (this.columns[column]![place] = value(name)));
    this.count += 1;
  }

  /** Return the samples of the last so many, some left out where they are more than `most`, and their values. */
  last(samples: number, most: number, names: string[]): { samples: number[]; values: number[][] } {
    const first = Math.max(0, this.count - Math.min(samples, this.capacity));
    const stride = Math.max(1, Math.ceil(samples / most));
    const found: number[] = [];
    // What is left out stays left out while the curve scrolls, lest it tremble.
    for (let sample = Math.ceil(first / stride) * stride; sample < this.count; sample += stride) found.push(sample);
    if (this.count && found.at(-1) !== this.count - 1) found.push(this.count - 1);
    const values = names.map((name) => {
      const column = this.columns[this.names.indexOf(name)]!;
      return found.map((sample) => column[sample % this.capacity]!);
    });
    return { samples: found, values };
  }
}
