/** The work of the worker: it loads a report's data once, then runs what it is asked for last. */

import { unpacked, unpackedNumbers } from "./bytes.ts";
import { inputsOf } from "./inputs.ts";
import { LiveLoop } from "./live_loop.ts";
import {
  FORM,
  type LiveData,
  type LoadMessage,
  type PageMessage,
  type RunMessage,
  type WorkerMessage,
} from "./messages.ts";

/** After so long what there is of a run is shown [ms]. */
const FIRST_LOOK = 100;
/** About as long as a part of a run takes [ms]. */
const PART = 5;
/** What not every browser has. */
const NEEDED = ["WebAssembly", "DecompressionStream"];
/** A module with nothing in it: where even this is refused, WebAssembly is forbidden. */
const NOTHING = Uint8Array.of(0x00, 0x61, 0x73, 0x6d, 1, 0, 0, 0);

/** What a session has of its surroundings. */
export interface Surroundings {
  post(message: WorkerMessage, transfer: Transferable[]): void;
  /** [ms] */
  now(): number;
  /** Let messages come in that have arrived. */
  breathe(): Promise<void>;
}

/** What the reader is told in place of sliders. */
class Refusal extends Error {}

export class Session {
  readonly #around: Surroundings;
  /** null until the data is loaded. */
  #loops: LiveLoop[] | null = null;
  #waiting: RunMessage | null = null;
  #busy = false;

  constructor(around: Surroundings) {
    this.#around = around;
  }

  /** Take a message, and end when nothing is to be done any more. */
  async take(message: PageMessage): Promise<void> {
    if (message.kind === "run") this.#waiting = message;
    if (this.#busy) return;
    this.#busy = true;
    if (message.kind === "load") await this.#orTell(this.#load(message));
    while (this.#loops && this.#waiting) await this.#orTell(this.#run(this.#loops, this.#waiting));
    this.#busy = false;
  }

  /** Wait for what is being done, and tell the reader why it cannot be. */
  async #orTell(work: Promise<void>): Promise<void> {
    try {
      await work;
    } catch (error) {
      const words = error instanceof Refusal ? error.message : `The run broke off: ${wordsOf(error)}.`;
      this.#around.post({ kind: "refused", words }, []);
    }
  }

  async #load({ data, samples, frequencies }: LoadMessage): Promise<void> {
    if (data.form !== FORM) {
      throw new Refusal(
        "This report was written by another version of Clepsydra than its script, so nothing can be moved here.",
      );
    }
    const modules = await compiled(data);
    const events = samples.map((each, event) => each.map((sample) => data.starts[event]! + sample));
    const common = { data, modules, inputs: await inputsOf(data), events, frequencies };
    const loops = data.controllers.map(async (controller) => {
      const plant = controller.plant && (await unpackedNumbers(controller.plant.packed));
      return new LiveLoop(common, controller, plant);
    });
    this.#loops = await Promise.all(loops);
    this.#around.post({ kind: "ready" }, []);
  }

  async #run(loops: LiveLoop[], { run, controller, values }: RunMessage): Promise<void> {
    const { post, now, breathe } = this.#around;
    const loop = loops[controller]!;
    this.#waiting = null;
    const began = now();
    const show = (): void => {
      const found = loop.found();
      const buffers = found.curves.flat().flatMap((curve) => (curve ? [curve.buffer as ArrayBuffer] : []));
      post({ kind: "ran", run, controller, ...found, milliseconds: now() - began }, buffers);
    };
    loop.begin(values);
    let shown = false;
    for (let before = began; loop.left > 0; before = now()) {
      loop.advance();
      const after = now();
      if (after - before < PART / 2) loop.pace *= 2;
      else if (after - before > 2 * PART) loop.pace = Math.ceil(loop.pace / 2);
      if (loop.left === 0 || after - began < FIRST_LOOK) continue;
      if (!shown) show();
      shown = true;
      // Before it has shown something none makes way, or nothing would be seen while one drags.
      await breathe();
      if (this.#waiting) return;
    }
    show();
    await breathe();
    if (this.#waiting) return;
    const found = loop.analysed(values);
    if (found) post({ kind: "analysed", run, controller, ...found }, []);
  }
}

async function compiled({ modules }: LiveData): Promise<WebAssembly.Module[]> {
  const missing = NEEDED.find((name) => !(name in globalThis));
  if (missing) throw new Refusal(`This browser has no ${missing}, so nothing can be moved here.`);
  try {
    await WebAssembly.compile(NOTHING);
  } catch {
    throw new Refusal("WebAssembly is forbidden here, by the browser or by the page around, so nothing can be moved.");
  }
  try {
    return await Promise.all(modules.map(async (each) => WebAssembly.compile(await unpacked(each))));
  } catch (error) {
    throw new Refusal(`A part of this report is damaged, so nothing can be moved here: ${wordsOf(error)}.`);
  }
}

function wordsOf(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
