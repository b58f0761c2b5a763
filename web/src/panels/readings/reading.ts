import type { Message } from "../../hub";

/** Shows the newest message of one type. */
export interface Reading {
  readonly element: HTMLElement;
  show(message: Message): void;
}
