/** Panes that are dragged by their heads to a side of another one. */
import type { Side } from "./layout";

/** Browsers tell it to what a pane is dragged over, before it is dropped. */
const TYPE = "application/x-fibws-pane";

/** Let a pane be dragged by its head. */
export function dragPane(head: HTMLElement, id: number): void {
  head.draggable = true;
  head.addEventListener("dragstart", ({ dataTransfer }) => {
    dataTransfer?.setData(TYPE, String(id));
    if (dataTransfer !== null) dataTransfer.effectAllowed = "move";
  });
}

/** Let panes be dropped on another one, whose `data-drop` is the side that the pane would get. */
export function dropPanes(element: HTMLElement, drop: (id: number, side: Side) => void): void {
  const sideOf = ({ clientX, clientY }: DragEvent): Side => {
    const { left, top, width, height } = element.getBoundingClientRect();
    return sideAt((clientX - left) / width, (clientY - top) / height);
  };
  element.addEventListener("dragover", (event) => {
    if (!event.dataTransfer?.types.includes(TYPE)) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = "move";
    element.dataset.drop = sideOf(event);
  });
  element.addEventListener("dragleave", ({ relatedTarget }) => {
    if (relatedTarget instanceof Node && element.contains(relatedTarget)) return;
    delete element.dataset.drop;
  });
  element.addEventListener("drop", (event) => {
    delete element.dataset.drop;
    const id = event.dataTransfer?.getData(TYPE) ?? "";
    if (id === "") return;
    event.preventDefault();
    drop(Number(id), sideOf(event));
  });
}

/** The nearest side of a place, whose left and upper end is 0 and whose right and lower end is 1. */
export function sideAt(x: number, y: number): Side {
  const distances: readonly (readonly [Side, number])[] = [
    ["left", x],
    ["right", 1 - x],
    ["above", y],
    ["below", 1 - y],
  ];
  return distances.reduce((least, each) => (each[1] < least[1] ? each : least))[0];
}
