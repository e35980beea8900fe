/** The worker of a live report: it runs scenarios beside the page. */

import type { PageMessage, WorkerMessage } from "./messages.ts";
import { Session } from "./session.ts";

/** What a worker has in the place of a window. */
interface Scope {
  onmessage: (event: MessageEvent<PageMessage>) => void;
  postMessage(message: WorkerMessage, transfer: Transferable[]): void;
}

const scope = self as unknown as Scope;
const { port1, port2 } = new MessageChannel();
const session = new Session({
  post: (message, transfer) => scope.postMessage(message, transfer),
  now: () => performance.now(),
  // A message to itself comes behind those that are there; a timer would wait for milliseconds.
  breathe: () =>
    new Promise((resolve) => {
      port1.onmessage = () => resolve();
      port2.postMessage(null);
    }),
});
scope.onmessage = ({ data }) => void session.take(data);
