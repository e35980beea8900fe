/** Files that are dropped before the laboratory listens: the browser would show them in its place. */

/** Hold what is dropped from now on, and return what drops it once more, for who listens then. */
export function holdDropped(): () => void {
  const held = new DataTransfer();
  const hold = (event: DragEvent): void => {
    event.preventDefault();
    for (const file of event.dataTransfer?.files ?? []) held.items.add(file);
  };
  addEventListener("dragover", hold);
  addEventListener("drop", hold);
  return () => {
    removeEventListener("dragover", hold);
    removeEventListener("drop", hold);
    if (held.files.length) dispatchEvent(new DragEvent("drop", { dataTransfer: held, cancelable: true }));
  };
}
