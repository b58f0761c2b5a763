/**
 * Elements are made here, and only so: text becomes text nodes, whatever it holds.
 *
 * Markup is never parsed, and there is no `style` attribute, which the page's policy forbids.
 */

export type Child = Node | string | number | null | undefined | false;
export type Listener = (event: never) => unknown;
export type Attributes = Record<string, string | number | boolean | null | undefined | Listener>;

const SVG = "http://www.w3.org/2000/svg";

/**
 * An HTML element.
 *
 * Attributes: a function under `on…` becomes a listener, `true` an attribute without a value;
 * `false`, `null` and `undefined` are left out; `value` and `checked` are set as properties.
 */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  dress(element, attributes);
  // After the children: a select has its value only once it has its options.
  append(element, children);
  if ("value" in attributes && "value" in element) {
    (element as { value: unknown }).value = attributes.value ?? "";
  }
  if ("checked" in attributes && element instanceof HTMLInputElement) {
    element.checked = attributes.checked === true;
  }
  return element;
}

/** An SVG element, with attributes as `h` takes them. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  dress(element, attributes);
  append(element, children);
  return element;
}

/** Give an element these children in place of those it has. */
export function replace(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Set an element's text, without touching the document when it says so already. */
export function say(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

function dress(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") {
      element.addEventListener(name.slice(2), value as unknown as EventListener);
    } else if (name === "checked" || (name === "value" && "value" in element)) {
    } else if (value === true) {
      element.setAttribute(name, "");
    } else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, String(value));
    }
  }
}

function append(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(typeof child === "number" ? String(child) : child);
  }
}
