/** Fields of topics that are dragged from the echo of a message onto a plot. */

/** Browsers tell it to what a field is dragged over, before it is dropped. */
const TYPE = "application/x-fibws-field";

/** Let the elements with `data-field` in a tree be dragged: that is the path of a field of a topic. */
export function dragFields(tree: HTMLElement, topic: string): void {
  tree.addEventListener("dragstart", ({ target, dataTransfer }) => {
    const element = target instanceof Element ? target.closest<HTMLElement>("[data-field]") : null;
    const path = element?.dataset.field;
    if (path === undefined || dataTransfer === null) return;
    dataTransfer.setData(TYPE, JSON.stringify([topic, path]));
    // What a form for fields reads.
    dataTransfer.setData("text/plain", `${topic}.${path}`);
    dataTransfer.effectAllowed = "copy";
  });
}

/** Let fields be dropped on an element, which has the class `drop-target` while one is over it. */
export function dropFields(
  element: HTMLElement,
  drop: (topic: string, path: string) => void,
): void {
  const over = (event: DragEvent): void => {
    if (!event.dataTransfer?.types.includes(TYPE)) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "copy";
    element.classList.add("drop-target");
  };
  element.addEventListener("dragenter", over);
  element.addEventListener("dragover", over);
  element.addEventListener("dragleave", ({ relatedTarget }) => {
    if (relatedTarget instanceof Node && element.contains(relatedTarget)) return;
    element.classList.remove("drop-target");
  });
  element.addEventListener("drop", (event) => {
    element.classList.remove("drop-target");
    const field = fieldFrom(event.dataTransfer?.getData(TYPE) ?? "");
    if (field === undefined) return;
    event.preventDefault();
    // A plot may be in a panel on which one can drop, too.
    event.stopPropagation();
    drop(...field);
  });
}

/** The topic and the path in what was dropped, which may come from any page. */
export function fieldFrom(text: string): [topic: string, path: string] | undefined {
  try {
    const value: unknown = JSON.parse(text);
    if (!Array.isArray(value) || value.length !== 2) return undefined;
    const [topic, path] = value as unknown[];
    return typeof topic === "string" && typeof path === "string" ? [topic, path] : undefined;
  } catch {
    return undefined;
  }
}
