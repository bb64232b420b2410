// Small helpers for elements.

type Child = Node | string;

/** An element with attributes and children; `on…` attributes are listeners. */
export function el<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Record<string, unknown> = {},
  ...children: Child[]): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on') && typeof value === 'function') {
      made.addEventListener(name.slice(2), value as EventListener);
    } else if (value === true) {
      made.setAttribute(name, '');
    } else if (value !== false && value !== null && value !== undefined) {
      made.setAttribute(name, String(value));
    }
  }
  made.append(...children);
  return made;
}

/** Sets text only where it differs, so that nothing is laid out in vain. */
export function say(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function put(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

export function card(title: string, ...children: Child[]): HTMLElement {
  return el('section', {class: 'card'}, el('h2', {}, title), ...children);
}

/** A button with its key; '': none. */
export function button(text: string, key: string, act: () => void, kind = ''): HTMLButtonElement {
  return el('button', {type: 'button', class: kind, onclick: act,
    ...(key ? {'aria-keyshortcuts': key, title: `${text} (${key})`} : {})}, text);
}
