/** What a reader pastes elsewhere. */

/** Add a button that copies the settings as a table that a spreadsheet takes. */
export function addCopyButton(card: HTMLElement): void {
  const table = card.querySelector("table");
  if (!table) return;
  const button = document.createElement("button");
  button.className = "copy";
  button.textContent = "Copy";
  button.setAttribute("aria-label", "Copy the settings");
  card.querySelector("h2")!.after(button);
  copyOnClick(button, () => tableText(table, card.querySelector("p")?.textContent ?? ""));
}

/** Let a button copy a text, and say for a moment that it did. */
export function copyOnClick(button: HTMLButtonElement, text: () => string): void {
  const words = button.textContent;
  button.addEventListener("click", async () => {
    await written(text());
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = words), 1500);
  });
}

function tableText(table: HTMLTableElement, note: string): string {
  const rows = [...table.rows].map((row) => [...row.cells].map((cell) => cell.textContent).join("\t"));
  return [...rows, note].join("\n");
}

async function written(text: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // A page that may not ask for the clipboard copies what is selected.
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}
