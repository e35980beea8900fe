/** The report of a lesson, which is printed: who did it, every task, and every figure. */

import { element } from "./faceplates.ts";
import { measuredText, verdict } from "./judged.ts";
import type { LessonData } from "./lesson_data.ts";
import type { NoteBook } from "./lesson_notes.ts";

export class LessonReport {
  readonly place = element("div", "report");
  private readonly data: LessonData;
  private readonly book: NoteBook;
  private readonly made: string;
  private readonly tasks = element("div", "");

  /** @param made Which page it is of. */
  constructor(data: LessonData, book: NoteBook, made: string) {
    this.data = data;
    this.made = made;
    this.book = book;
    const who = element("p", "who");
    const label = element("label", "", "Name for the report ");
    const field = Object.assign(element("input", ""), { type: "text", size: 24, autocomplete: "name", value: book.notes.reader });
    field.addEventListener("change", () => {
      book.notes.reader = field.value;
      book.keep();
      this.build();
    });
    label.append(field);
    who.append(label);
    this.place.append(who, this.tasks);
    this.tasks.className = "printed";
  }

  /** Write it anew. */
  build(): void {
    const { data, book } = this;
    const asked = data.tasks.flatMap((task, place) => (task.reach.length ? [book.notes.tasks[place]!.reached === task.reach.length] : []));
    const head = element("h2", "", `${data.title}: report`);
    const rig = data.variant ? `Rig of variant ${data.variant}. ` : "";
    const who = element("p", "", `${book.notes.reader || "Name:"}`);
    const summary = element("p", "", `${rig}${asked.filter(Boolean).length} of ${asked.length} tasks were reached.`);
    this.tasks.replaceChildren(head, who, summary, ...data.tasks.map((_, place) => this.task(place)), element("p", "made", this.made));
  }

  private task(place: number): HTMLElement {
    const task = this.data.tasks[place]!;
    const notes = this.book.notes.tasks[place]!;
    const section = element("section", "");
    section.append(element("h3", "", `${place + 1}. ${task.title}`));
    if (task.reach.length) {
      const list = element("ul", "");
      task.reach.forEach(({ words }, step) => list.append(element("li", "", `${step < notes.reached ? "✓" : "–"} ${words}`)));
      section.append(list);
    }
    if (task.figures.length) {
      const table = element("table", "");
      task.figures.forEach((figure, row) => {
        const line = table.insertRow();
        const name = element("th", "", figure.symbol ? `${figure.words}, ${figure.symbol}` : figure.words);
        name.scope = "row";
        const value = notes.measured[row];
        const typed = notes.typed[row]!;
        const told = figure.measure ? (value === null || value === undefined ? "–" : measuredText(figure, value)) : typed ? `${typed} ${figure.unit}` : "–";
        const judged = figure.measure ? (told === "–" ? "" : "measured") : verdict(figure, typed).words;
        line.append(name, element("td", "", told), element("td", "", judged));
      });
      section.append(table);
    }
    if (notes.hints) section.append(element("p", "", `${notes.hints} of ${task.hints.length} hints were asked for.`));
    return section;
  }
}
