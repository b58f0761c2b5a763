import { Source } from "../signal";

/** The time under the mouse, which all plots show. */
export const sharedCursor = new Source<number | undefined>(undefined);
