/**
 * Creates and changes elements. All elements are created here: text always becomes a text node.
 *
 * Markup is never parsed. `style` attributes are forbidden by the page's security policy.
 */

import { shownText } from "./text";

export type Child = Node | string | number | null | undefined | false;
export type Listener = (event: never) => unknown;
export type Attributes = Record<string, string | number | boolean | null | undefined | Listener>;

const SVG = "http://www.w3.org/2000/svg";

/**
 * Create an HTML element.
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
  setAttributes(element, attributes);
  append(element, children);
  // After the children: a select takes a value only once it has options.
  if ("value" in attributes && "value" in element) {
    (element as { value: unknown }).value = attributes.value ?? "";
  }
  if ("checked" in attributes && element instanceof HTMLInputElement) {
    element.checked = attributes.checked === true;
  }
  return element;
}

/** Create an SVG element; attributes are as for `h`. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  setAttributes(element, attributes);
  append(element, children);
  return element;
}

/** Replace all children of an element. */
export function replace(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Set an element's text; the document is touched only if it changes. */
export function setText(element: Element, text: string): void {
  const shown = shownText(text);
  if (element.textContent !== shown) element.textContent = shown;
}

/** The text of a name, of which a line may end after slashes and underscores only. */
export function breakable(name: string): Child[] {
  const [first = "", ...others] = name.split(/(?<=[/_])(?=[^/_])/);
  return [first, ...others.flatMap((word) => [h("wbr"), word])];
}

/** The characters at the end of a long name that are not cut off: names of one robot differ there. */
const END = 14;

/** An element with the text of a name, which is cut in the middle where there is too little room. */
export function cutName(name: string, className: string): HTMLElement {
  const at = name.length > 2 * END ? name.length - END : name.length;
  return h(
    "span",
    { class: `cut ${className}`, title: name },
    h("span", { class: "cut-start" }, name.slice(0, at)),
    at < name.length ? h("span", { class: "cut-end" }, name.slice(at)) : null,
  );
}

/** Set an element's text to a name; if it is too long for a line, the tooltip has all of it. */
export function setName(element: HTMLElement, name: string): void {
  if (element.textContent === name) return;
  replace(element, ...breakable(name));
  element.classList.add("ros-name");
  element.title = name;
}

/**
 * Put children of an element into a given order, moving as few of them as possible.
 *
 * New children are inserted; others are not removed. A child that has the focus keeps it.
 */
export function reorder(parent: Element, wanted: readonly Element[]): void {
  const focused = document.activeElement;
  const ranks = new Map(wanted.map((child, rank) => [child, rank]));
  const current = [...parent.children].flatMap((child) => ranks.get(child) ?? []);
  const stays = longestRising(current);
  let next: Element | null = null;
  for (let rank = wanted.length - 1; rank >= 0; rank -= 1) {
    const child = wanted[rank] as Element;
    // Moving a child costs as much as inserting a new one.
    if (!stays.has(rank)) parent.insertBefore(child, next);
    next = child;
  }
  const isLost = focused !== document.activeElement && parent.contains(focused);
  if (isLost && (focused instanceof HTMLElement || focused instanceof SVGElement)) {
    focused.focus({ preventScroll: true });
  }
}

/** The longest rising subsequence of some distinct numbers. */
export function longestRising(numbers: readonly number[]): Set<number> {
  // By length: the lowest number that a rising subsequence of that length can end with.
  const ends: number[] = [];
  const before = new Map<number, number | undefined>();
  for (const number of numbers) {
    let low = 0;
    let high = ends.length;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if ((ends[middle] as number) < number) low = middle + 1;
      else high = middle;
    }
    before.set(number, ends[low - 1]);
    ends[low] = number;
  }
  const found = new Set<number>();
  for (let at = ends.at(-1); at !== undefined; at = before.get(at)) found.add(at);
  return found;
}

/** Set an attribute; returns whether it changed. The document is touched only then. */
export function setAttribute(element: Element, name: string, value: string): boolean {
  const shown = shownText(value);
  if (element.getAttribute(name) === shown) return false;
  element.setAttribute(name, shown);
  return true;
}

function setAttributes(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    const isProperty = name === "checked" || (name === "value" && "value" in element);
    if (typeof value === "function") {
      element.addEventListener(name.slice(2), value as unknown as EventListener);
    } else if (isProperty) {
      // The caller sets it once the children are there.
    } else if (value === true) {
      element.setAttribute(name, "");
    } else if (value !== false && value !== null && value !== undefined) {
      element.setAttribute(name, shownText(String(value)));
    }
  }
}

function append(element: Element, children: Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(typeof child === "object" ? child : shownText(String(child)));
  }
}
