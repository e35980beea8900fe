/** Keys that do what buttons do, and the dialog that tells them. */

import { element } from "./faceplates.ts";

export interface Shortcut {
  /** As the event of the keyboard names it; what is told of it, if that is no name. */
  keys: string[];
  told: string;
  words: string;
  action: (key: string) => void;
}

/** Where keys are letters of what is typed, or choose something. */
const TYPED = 'input[type="text"], input[type="number"], select, textarea, dialog';
/** What the space bar presses already. */
const PRESSED = 'button, summary, a, input[type="checkbox"], [role="button"]';

export class Shortcuts {
  private readonly dialog = element("dialog", "help");
  private isOn = true;

  constructor(bar: HTMLElement, shortcuts: Shortcut[]) {
    const button = element("button", "ask", "?");
    button.setAttribute("aria-label", "Help: keys");
    button.title = "Help: keys (?)";
    button.addEventListener("click", () => this.open());
    // Before the words that change.
    bar.insertBefore(button, bar.querySelector(".told"));
    this.build(shortcuts);
    document.body.append(this.dialog);
    document.addEventListener("keydown", (event) => {
      const place = event.target instanceof Element ? event.target : document.body;
      if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey || place.closest(TYPED)) return;
      if (event.key === " " && place.closest(PRESSED)) return;
      if (event.key === "?") {
        event.preventDefault();
        this.open();
      }
      const found = this.isOn && shortcuts.find(({ keys }) => keys.includes(event.key));
      if (!found || event.repeat) return;
      event.preventDefault();
      found.action(event.key);
    });
  }

  private open(): void {
    if (!this.dialog.open) this.dialog.showModal();
  }

  private build(shortcuts: Shortcut[]): void {
    const title = element("h2", "", "Keys");
    title.id = "keys";
    this.dialog.setAttribute("aria-labelledby", title.id);
    const table = element("table", "");
    for (const { told, words } of [...shortcuts, { told: "?", words: "This list" }]) {
      const row = table.insertRow();
      const head = element("th", "");
      head.scope = "row";
      head.append(...told.split(" ").map((key) => element("kbd", "", key)));
      row.append(head);
      row.insertCell().textContent = words;
    }
    const label = element("label", "", " Keys of one letter do this");
    const box = Object.assign(element("input", ""), { type: "checkbox", checked: true });
    box.addEventListener("change", () => (this.isOn = box.checked));
    label.prepend(box);
    const close = element("button", "", "Close");
    close.addEventListener("click", () => this.dialog.close());
    const told = element("p", "", "On a slider the arrow keys move it, Page Up and Page Down by a tenth, Home and End to its ends; so does the wheel with Shift, or finely with Alt. A typed number may have a comma; Enter takes it, and Escape leaves the field.");
    this.dialog.append(title, table, told, label, close);
  }
}
