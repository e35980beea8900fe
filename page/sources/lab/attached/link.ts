/** The link of a page to the rig that it is of: a WebSocket that opens itself again. */

import type { Hand } from "../data.ts";
import { cellOf } from "./cells.ts";

/** What a rig says first. */
export interface Hello {
  /** What tells the plant from every other, and this start of its rig from those before. */
  plant: string;
  start: string;
  /** What a row holds behind its sample and its time. */
  columns: string[];
  /** Nothing that this page asks for is done. */
  isViewer: boolean;
}

export interface LinkListener {
  /** A rig answers. */
  met(hello: Hello): void;
  /** Samples, one after the other: each its number, its time [s since 1970], and what the columns hold [SI]. */
  samples(rows: Float64Array): void;
  /** The sample that is over, and what comes out of each delay behind it [SI]. */
  delayed(sample: number, values: number[]): void;
  /** A hand is felt in the sample behind this one at the latest. */
  taken(hand: Hand, sample: number): void;
  refused(hand: Hand, words: string): void;
  /** So many pages are open. */
  pages(count: number): void;
  /** It opened, or it was lost. */
  turned(): void;
}

type Said = { rig: Hello } | { delayed: [number, ...number[]] } | { taken: number } | { refused: string } | { pages: number };

/** A rig says every second that it is there; who hears nothing for so long looks for it anew [ms]. */
const SILENT = 4000;
/** It is tried again after this, and each time later, up to this [ms]. */
const [SOON, LATE] = [500, 5000];
const WATCH = 500;
/** Between two sendings [ms]. */
const PACE = 50;

export class Link {
  /** Whether a rig is heard. */
  isOpen = false;
  private readonly listener: LinkListener;
  private readonly address: () => string;
  private socket: WebSocket | undefined;
  private wait = SOON;
  private heard = 0;
  private isEnded = false;
  /** What is to be sent, by what it sets. */
  private readonly waiting = new Map<string, Hand>();
  private isPaced = false;
  /** What was sent and is not answered yet; answers come in its order. */
  private readonly sent: Hand[] = [];

  /** @param address Returns where the rig is, with what the page has of it. */
  constructor(address: () => string, listener: LinkListener) {
    this.address = address;
    this.listener = listener;
    this.open();
    setInterval(() => this.watch(), WATCH);
  }

  /** Let a rig do something, of what a slider does on and on the last; what nobody hears is not done later. */
  send(hand: Hand): void {
    if (!this.isOpen) return;
    const cell = cellOf(hand);
    // The one that was first would be overtaken by what was done in between.
    this.waiting.delete(cell);
    this.waiting.set(cell, hand);
    if (this.isPaced) return;
    this.isPaced = true;
    // What one hand does at once goes at once.
    queueMicrotask(() => this.flush());
  }

  private flush(): void {
    this.isPaced = this.isOpen && this.waiting.size > 0;
    if (!this.isPaced) return;
    for (const hand of this.waiting.values()) {
      this.sent.push(hand);
      this.socket!.send(JSON.stringify(hand));
    }
    this.waiting.clear();
    setTimeout(() => this.flush(), PACE);
  }

  /** Look for no rig any more. */
  end(): void {
    this.isEnded = true;
    this.socket?.close();
  }

  private open(): void {
    const socket = new WebSocket(this.address());
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.heard = performance.now();
    socket.addEventListener("message", ({ data }: MessageEvent<ArrayBuffer | string>) => socket === this.socket && this.hear(data));
    socket.addEventListener("close", () => socket === this.socket && this.lose());
  }

  private hear(data: ArrayBuffer | string): void {
    const { listener } = this;
    this.heard = performance.now();
    if (typeof data !== "string") return listener.samples(new Float64Array(data));
    const said = JSON.parse(data) as Said;
    if ("rig" in said) {
      this.isOpen = true;
      this.wait = SOON;
      listener.met(said.rig);
      listener.turned();
    } else if ("delayed" in said) {
      const [sample, ...values] = said.delayed;
      listener.delayed(sample, values);
    } else if ("pages" in said) listener.pages(said.pages);
    else {
      const hand = this.sent.shift()!;
      if ("taken" in said) listener.taken(hand, said.taken);
      else listener.refused(hand, said.refused);
    }
  }

  private lose(): void {
    this.socket = undefined;
    this.sent.length = 0;
    this.waiting.clear();
    if (this.isOpen) {
      this.isOpen = false;
      this.listener.turned();
    }
    if (this.isEnded) return;
    setTimeout(() => this.open(), this.wait);
    this.wait = Math.min(LATE, 2 * this.wait);
  }

  /** A link that is cut somewhere on the way closes nothing: it falls silent. */
  private watch(): void {
    const { socket } = this;
    if (!socket || performance.now() - this.heard < SILENT) return;
    // Its own end may come minutes later.
    this.lose();
    socket.close();
  }
}
