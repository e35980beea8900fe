/** A dialog of the laboratory: a title, what stands in it, and its buttons at the end. */

import { element } from "./faceplates.ts";

let made = 0;

export class Dialog {
  readonly place = element("dialog", "law");
  readonly body = element("div", "");
  readonly buttons = element("p", "buttons");
  private readonly title = element("h2", "");

  constructor() {
    this.title.id = `dialog-${(made += 1)}`;
    this.place.setAttribute("aria-labelledby", this.title.id);
    this.place.append(this.title, this.body, this.buttons);
    document.body.append(this.place);
  }

  show(title: string): void {
    this.title.textContent = title;
    this.place.showModal();
  }

  close(): void {
    this.place.close();
  }

  button(words: string, action: () => void): HTMLButtonElement {
    const found = element("button", "", words);
    found.addEventListener("click", action);
    this.buttons.append(found);
    return found;
  }
}

/** Return a select with its label; the first option where none is given. */
export function selectOf(words: string, options: string[], chosen = 0): { label: HTMLLabelElement; select: HTMLSelectElement } {
  const label = element("label", "", `${words} `);
  const select = element("select", "");
  select.append(...options.map((each) => element("option", "", each)));
  select.selectedIndex = chosen;
  label.append(select);
  return { label, select };
}
