/** What trends show of a run: from which sample to which, and two cursors. */

/** Samples that are seen, at least. */
const FEWEST = 10;
/** Changes of the length so small are those of rounding. */
const NOTHING = 1e-9;

export class View {
  /** Samples that are seen. */
  length: number;
  /** Where they end, where that is not now. */
  private end: number | undefined;
  /** Of the run: the oldest sample that there is, and the one to come. */
  private oldest = 0;
  private now = 0;
  /** Two samples, or those of them that there are. */
  private placed: number[] = [];
  /** The cursor that was moved at last. */
  active = 0;

  constructor(length: number) {
    this.length = length;
  }

  /** Learn how far the run goes: from its oldest sample to before `now`. */
  reach(oldest: number, now: number): void {
    [this.oldest, this.now] = [oldest, now];
    const last = Math.max(oldest, now - 1);
    this.placed = this.placed.map((each) => Math.min(Math.max(each, oldest), last));
  }

  get isFollowing(): boolean {
    return this.end === undefined;
  }

  get first(): number {
    const end = this.end ?? this.now;
    return Math.max(this.oldest, end - this.length);
  }

  get last(): number {
    return this.first + this.length;
  }

  /** See so many samples up to now. */
  follow(length = this.length): void {
    this.length = Math.max(FEWEST, length);
    this.end = undefined;
  }

  /** See all that there is. */
  all(): void {
    this.follow(this.now - this.oldest);
  }

  /** See a stretch; one that reaches now goes on with it. */
  show(first: number, last: number): void {
    const middle = (first + last) / 2;
    const half = Math.max(FEWEST, Math.min(last - first, this.longest)) / 2;
    this.place(middle - half, 2 * half);
  }

  /** See more or less, with one sample where it is. */
  zoom(factor: number, about: number): void {
    const length = Math.min(Math.max(this.length * factor, FEWEST), this.longest);
    const real = length / this.length;
    if (Math.abs(real - 1) < NOTHING) return;
    this.place(about - (about - this.first) * real, length);
  }

  pan(samples: number): void {
    this.place(this.first + samples, this.length);
  }

  /** The cursors, in their own order; both are there, or one, or none. */
  get cursors(): readonly number[] {
    return this.placed;
  }

  /** The samples between the cursors, in the order of time; undefined without two of them. */
  get stretch(): [number, number] | undefined {
    const [one, other] = this.placed;
    if (one === undefined || other === undefined || one === other) return undefined;
    return one < other ? [one, other] : [other, one];
  }

  /** Set a cursor: the first, then the second, and then the nearer of the two. */
  mark(sample: number): void {
    if (this.placed.length < 2) this.active = this.placed.length;
    else this.active = Math.abs(this.placed[0]! - sample) <= Math.abs(this.placed[1]! - sample) ? 0 : 1;
    this.move(sample);
  }

  /** Move the active cursor to a sample that there is. */
  move(sample: number): void {
    const last = Math.max(this.oldest, this.now - 1);
    this.placed[this.active] = Math.min(Math.max(Math.round(sample), this.oldest), last);
  }

  unmark(): void {
    this.placed = [];
    this.active = 0;
  }

  private get longest(): number {
    return Math.max(this.length, this.now - this.oldest, FEWEST);
  }

  private place(first: number, length: number): void {
    this.length = length;
    const start = Math.max(this.oldest, first);
    this.end = start + length >= this.now ? undefined : start + length;
  }
}
