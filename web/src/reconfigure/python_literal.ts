/** Reads Python literals, in which dynamic_reconfigure writes the values of enumerations. */

export type Literal = null | boolean | number | string | Literal[] | Map<Literal, Literal>;

const TOKEN = /\s*([[\](){},:]|[uUbB]?(?:'(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*")|[\w.+-]+)/suy;
const CLOSING: Record<string, string> = { "[": "]", "(": ")", "{": "}" };
const NAMES = new Map<string, Literal>([
  ["None", null],
  ["True", true],
  ["False", false],
]);
const ESCAPES: Record<string, string> = { n: "\n", t: "\t", r: "\r", "\n": "" };
const MAX_DEPTH = 20;

/** The value of a literal of dicts (as maps), lists, tuples, texts, numbers, booleans and None. */
export function literalOf(text: string): Literal {
  TOKEN.lastIndex = 0;
  let token = next();

  function next(): string {
    const at = TOKEN.lastIndex;
    const found = TOKEN.exec(text);
    if (found !== null) return found[1] as string;
    if (text.slice(at).trim() === "") return "";
    throw new Error(`invalid Python literal at character ${at}`);
  }

  function take(expected: string): void {
    if (token !== expected) throw new Error(`expected “${expected}”, got “${token}”`);
    token = next();
  }

  function value(depth: number): Literal {
    if (depth > MAX_DEPTH) throw new Error(`nested more than ${MAX_DEPTH} deep`);
    const first = token;
    token = next();
    const closing = CLOSING[first];
    if (closing === undefined) return scalar(first);
    const map = new Map<Literal, Literal>();
    const list: Literal[] = [];
    while (token !== closing) {
      const element = value(depth + 1);
      if (first === "{") {
        take(":");
        map.set(element, value(depth + 1));
      } else {
        list.push(element);
      }
      if (token !== closing) take(",");
    }
    take(closing);
    return first === "{" ? map : list;
  }

  const found = value(0);
  if (token !== "") throw new Error(`unexpected “${token}”`);
  return found;
}

function scalar(token: string): Literal {
  const named = NAMES.get(token);
  if (named !== undefined) return named;
  const quoted = /^[uUbB]?(['"])(.*)\1$/su.exec(token);
  if (quoted !== null) {
    const escaped = /\\(?:x([\da-f]{2})|u([\da-f]{4})|(.))/gisu;
    return (quoted[2] as string).replaceAll(escaped, (_all, byte, code, letter) =>
      letter === undefined
        ? String.fromCharCode(Number.parseInt(byte ?? code, 16))
        : (ESCAPES[letter] ?? letter),
    );
  }
  const number = Number(token.replace(/[lL]$/u, ""));
  if (token === "" || Number.isNaN(number)) throw new Error(`unexpected “${token}”`);
  return number;
}
