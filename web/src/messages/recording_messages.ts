/** What the page and the worker say to each other about a recording. */

export interface Topic {
  readonly name: string;
  /** As ROS 1 names it. */
  readonly type: string;
  /** Its definition as text; empty if there is none. */
  readonly definition: string;
}

/** Files of the browser that are one recording, or a file of a server, with the token that this wants. */
export type Origin =
  | { readonly name: string; readonly files: readonly File[] }
  | { readonly url: string; readonly token: string };

/** Show a recording in place of what comes. */
export interface FileRequest {
  readonly kind: "play file";
  readonly id?: undefined;
  readonly origin: Origin;
}

/** What the page learns of a recording. */
export interface RecordingReport {
  readonly kind: "recording";
  readonly name: string;
  readonly size: number;
  readonly topics: readonly Topic[];
  readonly warnings: readonly string[];
  /** Why it cannot be shown; empty if it can. */
  readonly fault: string;
}
