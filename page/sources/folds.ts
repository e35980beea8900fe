/** What is folded is filled when it is opened. */

export function fillWhenOpened(): void {
  document.addEventListener("toggle", ({ target }) => {
    if (!(target instanceof HTMLDetailsElement) || !target.open) return;
    const template = target.querySelector<HTMLTemplateElement>(":scope > template");
    template?.replaceWith(template.content);
  }, true);
}
