/** The statuses of all devices as a tree, the worst first, and how their levels have changed. */

/** The levels of diagnostic_msgs/DiagnosticStatus. */
export const LEVELS = ["ok", "warn", "error", "stale"] as const;
export type Level = (typeof LEVELS)[number];

/** A diagnostic_msgs/DiagnosticStatus. */
export interface Status {
  readonly level: number;
  readonly name: string;
  readonly message: string;
  readonly hardware_id: string;
  readonly values: readonly { readonly key: string; readonly value: string }[];
}

/** A status, or a branch of statuses; a status may have others below it. */
export interface Item {
  /** From the root, with slashes. */
  readonly path: string;
  /** The last part of the path. */
  readonly label: string;
  /** The worst of its own and of those below it. */
  level: Level;
  status: Status | undefined;
  readonly children: Map<string, Item>;
}

export interface Change {
  /** In ms since 1970. */
  readonly time: number;
  readonly name: string;
  readonly from: Level;
  readonly to: Level;
  readonly message: string;
}

/** A status is stale after this time without another one, in ms, as in rqt_robot_monitor. */
const STALE = 5000;
/** Most statuses; more are not shown. */
export const MAX_ITEMS = 2000;
const MAX_CHANGES = 50;
/** How bad each level is. */
const BADNESS: Record<Level, number> = { ok: 0, warn: 1, stale: 2, error: 3 };

interface Known {
  status: Status;
  level: Level;
  time: number;
}

export class DiagnosticsTree {
  /** The last changes of levels, the newest first. */
  readonly changes: Change[] = [];
  readonly #known = new Map<string, Known>();
  #root: Item = branch("", "");
  #isFull = false;

  get root(): Item {
    return this.#root;
  }

  /** Whether there are more statuses than are shown. */
  get isFull(): boolean {
    return this.#isFull;
  }

  /** How many statuses have each level. */
  get counts(): Record<Level, number> {
    const counts = { ok: 0, warn: 0, error: 0, stale: 0 };
    for (const { level } of this.#known.values()) counts[level] += 1;
    return counts;
  }

  /** Take the statuses of a message that has arrived at `now`, in ms since 1970. */
  update(statuses: readonly Status[], now: number): void {
    for (const status of statuses) {
      const known = this.#known.get(status.name);
      const level = LEVELS[status.level] ?? "error";
      if (known === undefined) {
        this.#isFull ||= this.#known.size >= MAX_ITEMS;
        if (this.#known.size >= MAX_ITEMS) continue;
        this.#known.set(status.name, { status, level, time: now });
        if (level !== "ok") this.#changed(status, "ok", level, now);
      } else {
        if (known.level !== level) this.#changed(status, known.level, level, now);
        Object.assign(known, { status, level, time: now });
      }
    }
    this.age(now);
  }

  /** Let statuses become stale that have not been repeated. */
  age(now: number): void {
    for (const known of this.#known.values()) {
      if (known.level === "stale" || now - known.time < STALE) continue;
      this.#changed(known.status, known.level, "stale", now);
      known.level = "stale";
    }
    this.#build();
  }

  #changed({ name, message }: Status, from: Level, to: Level, time: number): void {
    this.changes.unshift({ time, name, from, to, message });
    this.changes.length = Math.min(this.changes.length, MAX_CHANGES);
  }

  #build(): void {
    const root = branch("", "");
    for (const { status, level } of this.#known.values()) {
      let item = root;
      for (const label of pathOf(status.name)) {
        let next = item.children.get(label);
        if (next === undefined) {
          next = branch(`${item.path}/${label}`, label);
          item.children.set(label, next);
        }
        item = next;
      }
      item.status = status;
      item.level = level;
    }
    worst(root);
    this.#root = root;
  }
}

function branch(path: string, label: string): Item {
  return { path, label, level: "ok", status: undefined, children: new Map() };
}

/** The branches of a status: those of an aggregator's name, or the node and the check. */
export function pathOf(name: string): string[] {
  const parts = name.split("/").filter((part) => part !== "");
  if (parts.length > 1 || name.startsWith("/")) return parts;
  const [node = "", ...check] = name.split(": ");
  return check.length === 0 ? [name] : [node, check.join(": ")];
}

/** Set the level of an item to the worst below it. */
function worst(item: Item): Level {
  for (const child of item.children.values()) {
    const level = worst(child);
    if (BADNESS[level] > BADNESS[item.level]) item.level = level;
  }
  return item.level;
}

/** The items below one, the worst first, then by name. */
export function sorted(item: Item): Item[] {
  return [...item.children.values()].sort(
    (a, b) => BADNESS[b.level] - BADNESS[a.level] || a.label.localeCompare(b.label),
  );
}

/** Whether an item, or any below it, has a text in its name or its message. */
export function matches(item: Item, text: string): boolean {
  const own = `${item.path} ${item.status?.message ?? ""}`.toLowerCase();
  return own.includes(text) || [...item.children.values()].some((child) => matches(child, text));
}
