/** What is folded is filled when it is opened. */

export function fillWhenOpened(): void {
  document.addEventListener("toggle", ({ target }) => {
    if (!(target instanceof HTMLDetailsElement) || !target.open) return;
    const template = target.querySelector<HTMLTemplateElement>(":scope > template");
    template?.replaceWith(template.content);
    letScroll();
  }, true);
}

/** Let the keyboard scroll what is wider than the page. */
export function letScroll(): void {
  for (const wide of document.querySelectorAll<HTMLElement>(".wide, .picture, .drawing"))
    if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;
}
