/** Texts of messages, which need not be UTF-8 in ROS 1. */

// A byte order mark at the start is a part of the text.
const strict = new TextDecoder("utf-8", { fatal: true, ignoreBOM: true });

/** Where the bytes 0x80 to 0xff are that are no UTF-8: lone surrogates, as Python's surrogateescape. */
const ESCAPES = 0xdc00;
const ESCAPED = /[\udc80-\udcff]/gu;

/** Decode a text; each byte that is not part of valid UTF-8 becomes a lone surrogate. */
export function decodeText(bytes: Uint8Array): string {
  try {
    return strict.decode(bytes);
  } catch {
    return decodeDamaged(bytes);
  }
}

/** A text to be shown: bytes that are no UTF-8 as `\xe9`. */
export function shownText(text: string): string {
  return text.replace(ESCAPED, (byte) => `\\x${(byte.charCodeAt(0) - ESCAPES).toString(16)}`);
}

function decodeDamaged(bytes: Uint8Array): string {
  const parts: string[] = [];
  for (let at = 0; at < bytes.length; ) {
    const character = characterAt(bytes, at);
    parts.push(character?.text ?? String.fromCharCode(ESCAPES + (bytes[at] ?? 0)));
    at += character?.size ?? 1;
  }
  return parts.join("");
}

function characterAt(bytes: Uint8Array, at: number): { text: string; size: number } | undefined {
  const first = bytes[at] ?? 0;
  const size = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
  try {
    return { text: strict.decode(bytes.subarray(at, at + size)), size };
  } catch {
    return undefined;
  }
}
