/** What a reader has done in a lesson, kept in the browser where it can keep anything. */

export interface TaskNotes {
  /** What was typed for each figure. */
  typed: string[];
  /** What was measured for each figure [SI]; null for what was not. */
  measured: (number | null)[];
  /** How many steps were reached, and whether the task is done. */
  reached: number;
  hints: number;
}

export interface Notes {
  reader: string;
  task: number;
  tasks: TaskNotes[];
}

export class NoteBook {
  readonly notes: Notes;
  private readonly key: string;

  constructor(key: string, figures: number[]) {
    this.key = `clepsydra-lesson ${key}`;
    this.notes = this.kept(figures) ?? {
      reader: "", task: 0,
      tasks: figures.map((count) => ({ typed: Array<string>(count).fill(""), measured: Array<null>(count).fill(null), reached: 0, hints: 0 })),
    };
  }

  /** Keep them; a browser that keeps nothing for a file forgets them when the page is closed. */
  keep(): void {
    try {
      localStorage.setItem(this.key, JSON.stringify(this.notes));
    } catch {
      return;
    }
  }

  /** Return what was kept of this very lesson. */
  private kept(figures: number[]): Notes | undefined {
    try {
      const found = JSON.parse(localStorage.getItem(this.key) ?? "null") as Notes | null;
      const fits = found?.tasks.length === figures.length
        && found.tasks.every(({ typed, measured }, place) => typed.length === figures[place] && measured.length === figures[place]);
      return fits ? found : undefined;
    } catch {
      return undefined;
    }
  }
}
