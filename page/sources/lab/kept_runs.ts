/** Runs that outlast the page: their sessions in what the browser keeps for it, one entry each. */

import type { LabData, SessionFile } from "./data.ts";
import { sessionOf } from "./session_file.ts";

export interface KeptRun {
  id: string;
  name: string;
  isPinned: boolean;
  session: SessionFile;
}

/** What the page needs of `localStorage`. */
export type Store = Pick<Storage, "length" | "key" | "getItem" | "setItem" | "removeItem">;

export class KeptRuns {
  private readonly data: LabData;
  private readonly store: Store | undefined;
  private readonly prefix: string;
  private readonly written = new Map<string, string>();

  constructor(data: LabData, store: Store | undefined) {
    this.data = data;
    this.store = store;
    this.prefix = `clepsydra laboratory ${data.digest} `;
  }

  /** Return the runs of this laboratory, the oldest first; what is damaged is passed over. */
  read(): KeptRun[] {
    const { store, prefix } = this;
    if (!store) return [];
    const found: KeptRun[] = [];
    for (let place = 0; place < store.length; ++place) {
      const key = store.key(place)!;
      if (!key.startsWith(prefix)) continue;
      const run = this.runOf(key.slice(prefix.length), store.getItem(key)!);
      if (run) found.push(run);
    }
    return found.sort((one, other) => (one.id < other.id ? -1 : 1));
  }

  /** Keep a run, and return whether there was room for it. */
  write({ id, ...run }: KeptRun): boolean {
    const text = JSON.stringify(run);
    if (!this.store || this.written.get(id) === text) return true;
    try {
      this.store.setItem(this.prefix + id, text);
    } catch {
      // It is full; what was kept of the run before is still there.
      return false;
    }
    this.written.set(id, text);
    return true;
  }

  remove(id: string): void {
    this.store?.removeItem(this.prefix + id);
    this.written.delete(id);
  }

  private runOf(id: string, text: string): KeptRun | undefined {
    try {
      const { name, isPinned, session } = JSON.parse(text) as KeptRun;
      return { id, name: String(name), isPinned: isPinned === true, session: sessionOf(session, this.data) };
    } catch {
      return undefined;
    }
  }
}

/** Return what the browser keeps for the page; a page within another one may have none. */
export function browserStore(): Store | undefined {
  try {
    return localStorage;
  } catch {
    return undefined;
  }
}
