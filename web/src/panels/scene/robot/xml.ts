/**
 * Reads XML: the page's security policy refuses the browser's own parser for texts.
 *
 * It takes what robot models and Collada files have: elements, attributes, text, comments, CDATA,
 * processing instructions, and the entities that need no DTD. Prefixes of names are kept.
 */

/** Elements in each other: more are an attack, or nobody's robot. */
const MAX_DEPTH = 200;

const ENTITIES: Readonly<Record<string, string>> = {
  amp: "&",
  apos: "'",
  gt: ">",
  lt: "<",
  quot: '"',
};

/** Something is wrong at a line. */
export class XmlError extends Error {
  constructor(line: number, fault: string) {
    super(`line ${line}: ${fault}`);
  }
}

export class XmlElement {
  readonly name: string;
  /** Where it begins. */
  readonly line: number;
  readonly attributes = new Map<string, string>();
  readonly children: XmlElement[] = [];
  /** The text in it, without that of its children. */
  text = "";

  constructor(name: string, line: number) {
    this.name = name;
    this.line = line;
  }

  /** The children of a name. */
  all(name: string): XmlElement[] {
    return this.children.filter((each) => each.name === name);
  }

  /** The first child of a name. */
  first(name: string): XmlElement | undefined {
    return this.children.find((each) => each.name === name);
  }

  get(name: string): string | undefined {
    return this.attributes.get(name);
  }

  /** An attribute that must be there. */
  required(name: string): string {
    const value = this.attributes.get(name);
    if (!value) throw this.fault(`<${this.name}> requires attribute ${name}`);
    return value;
  }

  /** An error at this element. */
  fault(text: string): XmlError {
    return new XmlError(this.line, text);
  }
}

/** The root of a document; throws an `XmlError`. */
export function readXml(text: string): XmlElement {
  return new Parser(text).document();
}

const NAME = /[^\s=/>"'<&]+/y;
const SPACE = /\s*/y;

class Parser {
  readonly #text: string;
  #at = 0;
  #line = 1;
  /** Up to where lines are counted. */
  #counted = 0;

  constructor(text: string) {
    this.#text = text.startsWith("\ufeff") ? text.slice(1) : text;
  }

  document(): XmlElement {
    const open: XmlElement[] = [];
    let root: XmlElement | undefined;
    for (;;) {
      const next = this.#text.indexOf("<", this.#at);
      const end = next < 0 ? this.#text.length : next;
      if (end > this.#at) this.#addText(open.at(-1), end);
      if (next < 0) break;
      if (this.#skip("<!--", "-->") || this.#skip("<?", "?>") || this.#skipDoctype()) continue;
      if (this.#startsWith("<![CDATA[")) {
        const from = this.#at + 9;
        this.#skip("<![CDATA[", "]]>");
        const parent = open.at(-1);
        if (parent !== undefined) parent.text += this.#text.slice(from, this.#at - 3);
        continue;
      }
      if (this.#startsWith("</")) {
        this.#close(open);
        continue;
      }
      const element = this.#open();
      const parent = open.at(-1);
      if (parent !== undefined) parent.children.push(element);
      else if (root === undefined) root = element;
      else throw this.#fault(`<${element.name}> follows the end of <${root.name}>`);
      if (this.#startsWith("/>")) {
        this.#at += 2;
        continue;
      }
      this.#at += 1;
      if (open.length === MAX_DEPTH) throw this.#fault("elements are nested too deeply");
      open.push(element);
    }
    const last = open.at(-1);
    if (last !== undefined) {
      throw this.#fault(`<${last.name}> of line ${last.line} has no end`);
    }
    if (root === undefined) throw this.#fault("expected XML, got no element");
    return root;
  }

  #addText(parent: XmlElement | undefined, end: number): void {
    const raw = this.#text.slice(this.#at, end);
    if (parent !== undefined) parent.text += this.#decoded(raw, this.#at);
    else if (raw.trim() !== "") {
      throw this.#fault(`expected an element, got ${JSON.stringify(raw.trim().slice(0, 50))}`);
    }
    this.#at = end;
  }

  #open(): XmlElement {
    const line = this.#lineHere();
    this.#at += 1;
    const element = new XmlElement(this.#name(), line);
    for (;;) {
      const before = this.#at;
      this.#match(SPACE);
      if (this.#startsWith(">") || this.#startsWith("/>")) return element;
      if (this.#at === this.#text.length) throw this.#fault(`<${element.name}> has no >`);
      if (this.#at === before) throw this.#fault(`invalid character in <${element.name}>`);
      const name = this.#name();
      this.#match(SPACE);
      if (!this.#startsWith("=")) throw this.#fault(`attribute ${name} has no value`);
      this.#at += 1;
      this.#match(SPACE);
      const quote = this.#text.charAt(this.#at);
      const end = this.#text.indexOf(quote, this.#at + 1);
      if ((quote !== '"' && quote !== "'") || end < 0) {
        throw this.#fault(`the value of attribute ${name} has no quotation marks`);
      }
      if (element.attributes.has(name)) throw this.#fault(`duplicate attribute ${name}`);
      const raw = this.#text.slice(this.#at + 1, end);
      if (raw.includes("<")) throw this.#fault(`the value of attribute ${name} has a <`);
      element.attributes.set(name, this.#decoded(raw, this.#at + 1));
      this.#at = end + 1;
    }
  }

  #close(open: XmlElement[]): void {
    this.#at += 2;
    const name = this.#name();
    this.#match(SPACE);
    const element = open.pop();
    if (element?.name !== name) {
      const expected = element === undefined ? "no end" : `</${element.name}>`;
      throw this.#fault(`expected ${expected}, got </${name}>`);
    }
    if (!this.#startsWith(">")) throw this.#fault(`</${name} has no >`);
    this.#at += 1;
  }

  #name(): string {
    const name = this.#match(NAME);
    if (name === "") throw this.#fault("expected a name");
    return name;
  }

  #match(pattern: RegExp): string {
    pattern.lastIndex = this.#at;
    const found = pattern.exec(this.#text)?.[0] ?? "";
    this.#at += found.length;
    return found;
  }

  #startsWith(text: string): boolean {
    return this.#text.startsWith(text, this.#at);
  }

  /** Skip what is between two marks, if the first one is here. */
  #skip(from: string, to: string): boolean {
    if (!this.#startsWith(from)) return false;
    const end = this.#text.indexOf(to, this.#at + from.length);
    if (end < 0) throw this.#fault(`${from} has no ${to}`);
    this.#at = end + to.length;
    return true;
  }

  #skipDoctype(): boolean {
    if (!this.#startsWith("<!DOCTYPE")) return false;
    const end = this.#text.indexOf(">", this.#at);
    if (end < 0) throw this.#fault("<!DOCTYPE has no >");
    if (this.#text.slice(this.#at, end).includes("[")) throw this.#fault("a DTD is not supported");
    this.#at = end + 1;
    return true;
  }

  #decoded(raw: string, from: number): string {
    if (!raw.includes("&")) return raw;
    return raw.replace(/&([^;&\s]{0,10});|&/g, (whole, name: string | undefined, at: number) => {
      const [, hex, decimal] = /^#(?:x([0-9a-f]+)|(\d+))$/i.exec(name ?? "") ?? [];
      if (hex !== undefined || decimal !== undefined) {
        const code = hex === undefined ? Number(decimal) : Number.parseInt(hex, 16);
        if (code <= 0x10ffff) return String.fromCodePoint(code);
      }
      const known = Object.hasOwn(ENTITIES, name ?? "") ? ENTITIES[name as string] : undefined;
      if (known === undefined) {
        this.#at = from + at;
        throw this.#fault(`unknown entity ${whole}`);
      }
      return known;
    });
  }

  #fault(text: string): XmlError {
    return new XmlError(this.#lineHere(), text);
  }

  #lineHere(): number {
    for (;;) {
      const next = this.#text.indexOf("\n", this.#counted);
      if (next < 0 || next >= this.#at) return this.#line;
      this.#line += 1;
      this.#counted = next + 1;
    }
  }
}
