/** A message as a tree, which stays as it was unfolded while the messages change. */
import { h, say } from "../dom";
import { plural, whole } from "../format";
import { type Field, kindOf, own, type Types, typeText } from "../types";
import { type Item, Leaf, leafText, type PlotPath } from "./leaf";
import "./tree.css";

/** Elements of an array that are shown at first, with each click, and at most. */
const FIRST = 50;
const STEP = 200;
const MOST = 2000;
/** Arrays up to this length, and messages down to this depth, are unfolded at first. */
const SHORT = 8;
const DEPTH = 2;

/** Values that stand for those of a folded branch. */
const PREVIEW = 4;

export class Tree {
  readonly element = h("div", { class: "tree" });
  readonly #branch: Children;
  readonly #type: string;

  /** Without types a message is shown as what its JSON says. */
  constructor(types: Types | undefined, type: string, plot?: PlotPath) {
    this.#type = type;
    this.#branch = new Children(this.element, { types, plot }, "", 0);
  }

  show(message: unknown): void {
    this.#branch.show(message, { name: "", type: this.#type, array: -1 });
  }
}

interface Context {
  readonly types: Types | undefined;
  readonly plot: PlotPath | undefined;
}

/** What is in a message or in an array. */
class Children {
  readonly #place: HTMLElement;
  readonly #context: Context;
  readonly #path: string;
  readonly #depth: number;
  readonly #items = new Map<string, Item>();
  readonly #more = h("button", {
    type: "button",
    class: "tree-more",
    onclick: () => this.#showMore(),
  });
  #limit = FIRST;
  #value: unknown;
  #field: Field | undefined;

  constructor(place: HTMLElement, context: Context, path: string, depth: number) {
    this.#place = place;
    this.#context = context;
    this.#path = path;
    this.#depth = depth;
  }

  show(value: unknown, field: Field | undefined): void {
    this.#value = value;
    this.#field = field;
    if (Array.isArray(value)) this.#showArray(value, field);
    else this.#showMessage(value, field);
  }

  #showMore(): void {
    this.#limit = Math.min(MOST, this.#limit + STEP);
    this.show(this.#value, this.#field);
  }

  #showMessage(value: unknown, field: Field | undefined): void {
    const keys =
      typeof value === "object" && value !== null ? Object.keys(value).slice(0, this.#limit) : [];
    for (const key of keys) {
      const inner = field === undefined ? undefined : this.#context.types?.field(field.type, key);
      this.#put(key, key, this.#path === "" ? key : `${this.#path}.${key}`, own(value, key), inner);
    }
    this.#prune(new Set(keys));
    if (keys.length === 0)
      this.#place.replaceChildren(h("span", { class: "tree-note" }, "no fields"));
  }

  #showArray(values: unknown[], field: Field | undefined): void {
    const element = field === undefined ? undefined : { ...field, array: -1 };
    const shown = Math.min(values.length, this.#limit);
    for (let at = 0; at < shown; at += 1) {
      this.#put(String(at), `[${at}]`, `${this.#path}[${at}]`, values[at], element);
    }
    for (let at = this.#items.size - 1; at >= shown; at -= 1) this.#remove(String(at));
    this.#place.classList.toggle("of-leaves", typeof values[0] !== "object");
    const rest = values.length - shown;
    if (rest === 0) {
      this.#more.remove();
    } else {
      const all = this.#limit >= MOST;
      say(
        this.#more,
        all ? `… ${whole(rest)} more: copy it as JSON to see all` : `… ${whole(rest)} more`,
      );
      this.#more.disabled = all;
      if (this.#place.lastChild !== this.#more) this.#place.append(this.#more);
    }
  }

  #put(key: string, label: string, path: string, value: unknown, field: Field | undefined): void {
    const former = this.#items.get(key);
    if (former?.show(value) === true) return;
    const item = makeItem(this.#context, label, path, value, field, this.#depth);
    this.#items.set(key, item);
    if (former === undefined) this.#place.append(item.element);
    else former.element.replaceWith(item.element);
  }

  #prune(keys: ReadonlySet<string>): void {
    for (const key of [...this.#items.keys()]) if (!keys.has(key)) this.#remove(key);
  }

  #remove(key: string): void {
    this.#items.get(key)?.element.remove();
    this.#items.delete(key);
  }
}

function makeItem(
  context: Context,
  label: string,
  path: string,
  value: unknown,
  field: Field | undefined,
  depth: number,
): Item {
  const single = field === undefined || field.array < 0;
  const kind = field === undefined ? undefined : kindOf(field.type);
  const isTime = single && (kind === "time" || kind === "duration");
  if (typeof value === "object" && value !== null && !isTime) {
    return new Branch(context, label, path, value, field, depth);
  }
  return new Leaf(context.plot, label, path, value, field);
}

class Branch implements Item {
  readonly element: HTMLDetailsElement;
  readonly #note = h("span", { class: "tree-note" });
  readonly #preview = h("span", { class: "tree-preview" });
  readonly #types: Types | undefined;
  readonly #children: Children;
  readonly #field: Field | undefined;
  readonly #isArray: boolean;
  #value: unknown;

  constructor(
    context: Context,
    label: string,
    path: string,
    value: object,
    field: Field | undefined,
    depth: number,
  ) {
    this.#field = field;
    this.#isArray = Array.isArray(value);
    this.#types = context.types;
    const place = h("div", { class: "tree-children" });
    this.#children = new Children(place, context, path, depth + 1);
    this.element = h(
      "details",
      { class: "tree-branch", open: depth < DEPTH && isShort(value) },
      h(
        "summary",
        {},
        h("span", { class: "tree-key" }, `${label}:`),
        " ",
        this.#note,
        this.#preview,
      ),
      place,
    );
    // What is folded costs nothing.
    this.element.addEventListener("toggle", () => this.#unfold());
    this.show(value);
  }

  show(value: unknown): boolean {
    if (typeof value !== "object" || value === null || Array.isArray(value) !== this.#isArray)
      return false;
    this.#value = value;
    say(this.#note, this.#describe(value));
    this.#unfold();
    return true;
  }

  #unfold(): void {
    if (this.element.open) this.#children.show(this.#value, this.#field);
    say(this.#preview, this.element.open ? "" : preview(this.#value, this.#field, this.#types));
  }

  #describe(value: object): string {
    const type = this.#field === undefined ? "" : typeText(this.#field);
    if (!Array.isArray(value)) return type;
    return `${type} ${plural(value.length, "element")}`.trim();
  }
}

function isShort(value: object): boolean {
  const length = Object.keys(value).length;
  return length > 0 && length <= SHORT;
}

/** The first few values in what is folded: ` x: 1.5, y: 0` or ` 1, 2, 3, …`. */
function preview(value: unknown, field: Field | undefined, types: Types | undefined): string {
  const isArray = Array.isArray(value);
  const element = field === undefined ? undefined : { ...field, array: -1 };
  const all = Object.entries(isArray ? value.slice(0, PREVIEW + 1) : (value as object));
  const texts = all.flatMap(([name, each]) => {
    const inner = isArray ? element : field && types?.field(field.type, name);
    if (typeof each === "object" && each !== null && own(each, "nsecs") === undefined) return [];
    const text = leafText(typeof each === "number" ? Number(each.toPrecision(5)) : each, inner)[0];
    return [isArray ? text : `${name}: ${text}`];
  });
  if (texts.length === 0) return "";
  const few = texts
    .slice(0, PREVIEW)
    .join(isArray ? ", " : "  ")
    .slice(0, 120);
  return `  ${few}${texts.length > PREVIEW ? ", …" : ""}`;
}
