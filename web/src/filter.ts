/** The words that one types to find something in a list. */

/** Whether all words of a text are in the fields, whatever the case. */
export function matches(text: string, ...fields: string[]): boolean {
  const all = fields.join(" ").toLowerCase();
  return text
    .toLowerCase()
    .split(/\s+/)
    .every((word) => all.includes(word));
}
