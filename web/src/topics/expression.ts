/**
 * What a curve shows of each message: a number, simple maths with numbers, or the elements of an array.
 *
 *     sum     = product { ("+" | "-") product }
 *     product = factor { ("*" | "/") factor }
 *     factor  = "-" factor | atom [ "^" factor ]
 *     atom    = number | field | function "(" sum { "," sum } ")" | "(" sum ")"
 *     field   = [ topic "." ] path
 *
 * A path is as in `poses[3].x`, `position[elbow]`, or `ranges[:]` and `ranges[10:20]` for arrays.
 */
import { resolve } from "../element_names";
import { elements, numberAt } from "../messages/values";
import { own, parsePath, pathText, type Step } from "../types";

/** No element of a message has the name: other nodes may publish the states of other joints. */
export const ABSENT = Symbol("absent");
/** A derivative needs one more message. */
export const WAITING = Symbol("waiting");

/** `undefined` if the message has no number there. */
export type Result = number | bigint | Float64Array | undefined | typeof ABSENT | typeof WAITING;

/** Why a text is not an expression. */
export class ExpressionError extends Error {}

interface Node {
  evaluate(message: unknown, time: number): Result;
  reset?(): void;
}

const FUNCTIONS: Readonly<Record<string, (...numbers: number[]) => number>> = {
  abs: Math.abs,
  acos: Math.acos,
  asin: Math.asin,
  atan: Math.atan,
  atan2: Math.atan2,
  cos: Math.cos,
  degrees: (radians = Number.NaN) => (radians * 180) / Math.PI,
  exp: Math.exp,
  floor: Math.floor,
  log: Math.log,
  log10: Math.log10,
  max: (one = Number.NaN, other = Number.NaN) => Math.max(one, other),
  min: (one = Number.NaN, other = Number.NaN) => Math.min(one, other),
  radians: (degrees = Number.NaN) => (degrees * Math.PI) / 180,
  round: Math.round,
  sin: Math.sin,
  sqrt: Math.sqrt,
  tan: Math.tan,
};
const OF_TWO = ["atan2", "max", "min"];
const DERIVATIVE = "derivative";

const OPERATORS: Readonly<Record<string, (one: number, other: number) => number>> = {
  "+": (one, other) => one + other,
  "-": (one, other) => one - other,
  "*": (one, other) => one * other,
  "/": (one, other) => one / other,
  "^": (one, other) => one ** other,
};

const NUMBER = /(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?/y;
const PATH = /[A-Za-z_]\w*(?:\[[^[\]]+\])*(?:\.[A-Za-z_]\w*(?:\[[^[\]]+\])*)*/y;
const CALL = /([A-Za-z_]\w*)\s*\(/y;
const TOPIC = /((?:\/[A-Za-z_]\w*)+)\./y;
const RANGE = /^(\d*):(\d*)$/;
/** The deepest nesting of an expression, so that no text overflows the stack. */
const MAX_DEPTH = 50;

export class Expression {
  /** The topic that fields are of, if the text names it. */
  readonly topic: string | undefined;
  /** Whether its values are arrays, of one value per index. */
  readonly isArray: boolean;
  readonly #root: Node;
  readonly #parts: readonly (string | Field)[];
  readonly #derivatives: readonly Derivative[];

  constructor(text: string) {
    const parser = new Parser(text.trim());
    this.#root = parser.parse();
    this.topic = parser.topic;
    this.#parts = parser.parts;
    this.#derivatives = parser.derivatives;
    this.isArray = parser.parts.some((part) => typeof part === "object" && part.isSlice);
    if (this.isArray && this.#derivatives.length > 0)
      throw new ExpressionError("The derivative of an array is not supported.");
  }

  /** The text, without the topic, and with the names of array elements once there was a message. */
  get text(): string {
    return this.#parts.map((part) => (typeof part === "string" ? part : part.text)).join("");
  }

  evaluate(message: unknown, time: number): Result {
    return this.#root.evaluate(message, time);
  }

  /** Forget earlier messages: the next one does not follow them. */
  reset(): void {
    for (const derivative of this.#derivatives) derivative.reset();
  }
}

/** Parse an expression; returns the reason if it is invalid. */
export function problemOf(text: string): string {
  try {
    new Expression(text);
    return "";
  } catch (error) {
    if (error instanceof ExpressionError) return error.message;
    throw error;
  }
}

class Field implements Node {
  #steps: readonly Step[];
  /** The steps to an array and the range of its elements; the other steps are within each. */
  readonly #slice: { at: number; first: number; last: number } | undefined;

  constructor(path: string) {
    this.#steps = parsePath(path) ?? [];
    const at = this.#steps.findIndex(isRange);
    if (at < 0) return;
    if (this.#steps.slice(at + 1).some(isRange))
      throw new ExpressionError(`${path} has two ranges: expected one.`);
    const [, first = "", last = ""] = RANGE.exec((this.#steps[at] as { name: string }).name) ?? [];
    this.#slice = { at, first: Number(first), last: last === "" ? Infinity : Number(last) };
  }

  get text(): string {
    return pathText(this.#steps);
  }

  get isSlice(): boolean {
    return this.#slice !== undefined;
  }

  evaluate(message: unknown): Result {
    if (this.#slice !== undefined) return this.#elements(message, this.#slice);
    const found = resolve(message, this.#steps);
    if (found === undefined) return ABSENT;
    const value = numberAt(message, found.indices);
    // From now on it is the element with this name, wherever that is.
    if (value !== undefined) this.#steps = found.named;
    return value;
  }

  #elements(message: unknown, slice: { at: number; first: number; last: number }): Result {
    const found = resolve(message, this.#steps.slice(0, slice.at));
    if (found === undefined) return ABSENT;
    const array = found.indices.reduce<unknown>(
      (value, step) => (typeof step === "string" ? own(value, step) : elements(value)?.[step]),
      message,
    );
    const list = elements(array);
    if (list === undefined) return undefined;
    const rest = this.#steps.slice(slice.at + 1);
    const end = Math.min(list.length, slice.last);
    return Float64Array.from({ length: Math.max(0, end - slice.first) }, (_, index) => {
      const element = list[slice.first + index];
      const indices = rest.length === 0 ? [] : (resolve(element, rest)?.indices ?? [""]);
      return Number(numberAt(element, indices) ?? Number.NaN);
    });
  }
}

function isRange(step: Step): boolean {
  return typeof step === "object" && RANGE.test(step.name);
}

/** A function of numbers, of which each may be the elements of an array. */
class Call implements Node {
  readonly #work: (...numbers: number[]) => number;
  readonly #inputs: readonly Node[];

  constructor(work: (...numbers: number[]) => number, inputs: readonly Node[]) {
    this.#work = work;
    this.#inputs = inputs;
  }

  evaluate(message: unknown, time: number): Result {
    const values: (number | Float64Array)[] = [];
    let length = Infinity;
    let hole: Result = 0;
    // All of them, as each derivative needs each message.
    for (const input of this.#inputs) {
      const value = input.evaluate(message, time);
      if (value === undefined || typeof value === "symbol") hole = value;
      else if (typeof value === "object") {
        values.push(value);
        length = Math.min(length, value.length);
      } else values.push(Number(value));
    }
    if (hole !== 0) return hole;
    const at = (index: number): number =>
      this.#work(...values.map((each) => (typeof each === "object" ? Number(each[index]) : each)));
    return length === Infinity ? at(0) : Float64Array.from({ length }, (_, index) => at(index));
  }
}

/** The change per second since the message before. */
class Derivative implements Node {
  readonly #input: Node;
  #last: { readonly time: number; readonly value: number | bigint } | undefined;

  constructor(input: Node) {
    this.#input = input;
  }

  evaluate(message: unknown, time: number): Result {
    const value = this.#input.evaluate(message, time);
    if (typeof value !== "number" && typeof value !== "bigint") return value;
    const last = this.#last;
    if (last !== undefined && time <= last.time) return WAITING;
    this.#last = { time, value };
    if (last === undefined) return WAITING;
    // The difference of integers of 64 bits is exact, too.
    const isExact = typeof value === "bigint" && typeof last.value === "bigint";
    const change = isExact
      ? Number(value - (last.value as bigint))
      : Number(value) - Number(last.value);
    return change / (time - last.time);
  }

  reset(): void {
    this.#last = undefined;
  }
}

class Parser {
  readonly parts: (string | Field)[] = [];
  readonly derivatives: Derivative[] = [];
  topic: string | undefined;
  readonly #text: string;
  #at = 0;
  #depth = 0;

  constructor(text: string) {
    this.#text = text;
  }

  parse(): Node {
    if (this.#text === "") throw new ExpressionError("Expected a field, such as data.");
    const root = this.#sum();
    if (this.#at < this.#text.length) this.#fail("an operator");
    if (!this.parts.some((part) => typeof part === "object"))
      throw new ExpressionError(`${this.#text} has no field of a message.`);
    return root;
  }

  #sum(): Node {
    return this.#chain(["+", "-"], () => this.#product());
  }

  #product(): Node {
    return this.#chain(["*", "/"], () => this.#factor());
  }

  /** Operands with operators between them, from left to right. */
  #chain(operators: readonly string[], operand: () => Node): Node {
    let left = operand();
    for (;;) {
      const operator = operators.find((each) => this.#take(each));
      if (operator === undefined) return left;
      left = new Call(OPERATORS[operator] as (typeof OPERATORS)[string], [left, operand()]);
    }
  }

  #factor(): Node {
    this.#depth += 1;
    if (this.#depth > MAX_DEPTH)
      throw new ExpressionError(`An expression nests at most ${MAX_DEPTH} levels.`);
    try {
      if (this.#take("-")) return new Call((value = Number.NaN) => -value, [this.#factor()]);
      const base = this.#atom();
      if (!this.#take("^")) return base;
      return new Call(OPERATORS["^"] as (typeof OPERATORS)[string], [base, this.#factor()]);
    } finally {
      this.#depth -= 1;
    }
  }

  #atom(): Node {
    if (this.#take("(")) {
      const inner = this.#sum();
      if (!this.#take(")")) this.#fail(")");
      return inner;
    }
    const number = this.#match(NUMBER)?.[0];
    if (number !== undefined) {
      this.parts.push(number);
      const value = Number(number);
      return { evaluate: () => value };
    }
    const call = this.#match(CALL);
    if (call !== undefined) return this.#call(call[0], call[1] ?? "");
    const topic = this.#match(TOPIC)?.[1];
    if (topic !== undefined) {
      if (this.topic !== undefined && this.topic !== topic)
        throw new ExpressionError(
          `A curve has fields of one topic, not of ${this.topic} and ${topic}.`,
        );
      this.topic = topic;
    }
    const path = this.#match(PATH)?.[0];
    if (path === undefined) return this.#fail("a field or a number");
    const field = new Field(path);
    this.parts.push(field);
    return field;
  }

  #call(start: string, name: string): Node {
    const work = Object.hasOwn(FUNCTIONS, name) ? FUNCTIONS[name] : undefined;
    if (work === undefined && name !== DERIVATIVE) {
      const known = [...Object.keys(FUNCTIONS), DERIVATIVE].sort().join(", ");
      throw new ExpressionError(`Unknown function ${name}; there are ${known}.`);
    }
    this.parts.push(start);
    const inputs = [this.#sum()];
    while (this.#take(",")) inputs.push(this.#sum());
    if (!this.#take(")")) this.#fail(")");
    const count = OF_TWO.includes(name) ? 2 : 1;
    if (inputs.length !== count)
      throw new ExpressionError(`${name} takes ${count} values, got ${inputs.length}.`);
    if (work !== undefined) return new Call(work, inputs);
    const derivative = new Derivative(inputs[0] as Node);
    this.derivatives.push(derivative);
    return derivative;
  }

  /** Take a sign if it comes next. */
  #take(sign: string): boolean {
    const space = /\s*/y;
    space.lastIndex = this.#at;
    const gap = space.exec(this.#text)?.[0] ?? "";
    if (!this.#text.startsWith(sign, this.#at + gap.length)) return false;
    this.#at += gap.length + sign.length;
    this.parts.push(gap + sign);
    return true;
  }

  #match(pattern: RegExp): RegExpExecArray | undefined {
    const space = /\s*/y;
    space.lastIndex = this.#at;
    const gap = space.exec(this.#text)?.[0] ?? "";
    pattern.lastIndex = this.#at + gap.length;
    const found = pattern.exec(this.#text);
    if (found === null) return undefined;
    if (gap !== "") this.parts.push(gap);
    this.#at = pattern.lastIndex;
    return found;
  }

  #fail(expected: string): never {
    const rest = this.#text.slice(this.#at).trim();
    const found = rest === "" ? "the end" : `“${rest.slice(0, 20)}”`;
    throw new ExpressionError(`Expected ${expected}, got ${found}.`);
  }
}
