/** A field for a typed number of a signal: one that is refused is marked, with the reason beside it. */

import type { ShownSignal } from "./data.ts";
import { typed } from "./quantities.ts";

let made = 0;

export class TypedField {
  readonly field = document.createElement("input");
  /** Why what was typed is refused. */
  readonly reason = document.createElement("p");
  /** Whether a hand has typed what is not taken yet. */
  private isTyped = false;

  constructor(label: string, signal: ShownSignal, set: (value: number) => void) {
    const { field, reason } = this;
    Object.assign(field, { type: "text", inputMode: "decimal", size: 7, autocomplete: "off" });
    field.setAttribute("aria-label", label);
    Object.assign(reason, { className: "reason", hidden: true, id: `reason-${++made}` });
    reason.setAttribute("role", "alert");
    field.addEventListener("input", () => (this.isTyped = true));
    field.addEventListener("blur", () => (this.isTyped = false));
    field.addEventListener("change", () => {
      this.isTyped = false;
      const found = typed(signal, field.value);
      if (typeof found === "number") {
        this.clear();
        set(found);
      } else this.refuse(found);
    });
    // The next number replaces this one. At the press of the key it would come a frame before the change
    // is told, in a task of its own after what is typed next.
    field.addEventListener("keypress", ({ key }) => {
      if (key !== "Enter") return;
      this.isTyped = false;
      field.select();
    });
    field.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape") return;
      this.clear();
      field.blur();
    });
  }

  /** Show a number, unless a hand is typing another one. */
  show(text: string): void {
    const { field } = this;
    // A cursor in it is about to type, and a part that is selected to be replaced.
    const isInHand = document.activeElement === field && (this.isTyped || field.selectionStart === field.selectionEnd);
    if (!isInHand && !this.isRefused && field.value !== text) this.write(text);
  }

  /** Forget what was refused. */
  clear(): void {
    this.reason.hidden = true;
    this.field.removeAttribute("aria-invalid");
    this.field.removeAttribute("aria-describedby");
  }

  private get isRefused(): boolean {
    return !this.reason.hidden;
  }

  private write(text: string): void {
    const { field } = this;
    const isFocused = document.activeElement === field;
    field.value = text;
    if (isFocused) field.select();
  }

  private refuse(words: string): void {
    this.reason.textContent = words;
    this.reason.hidden = false;
    this.field.setAttribute("aria-invalid", "true");
    this.field.setAttribute("aria-describedby", this.reason.id);
  }
}
