import { timeOfDay } from "../format";

/** One thing that a node has said. */
export interface Entry {
  /** Counted from 1, without gaps. */
  number: number;
  secs: number;
  nsecs: number;
  level: number;
  node: string;
  text: string;
  /** File, line and function; empty if they are not known. */
  where: string;
}

export interface Level {
  value: number;
  /** As ROS writes it. */
  name: string;
}

/** The levels of rosgraph_msgs/Log, the least grave first. */
export const LEVELS: readonly Level[] = [
  { value: 1, name: "DEBUG" },
  { value: 2, name: "INFO" },
  { value: 4, name: "WARN" },
  { value: 8, name: "ERROR" },
  { value: 16, name: "FATAL" },
];

/** The word for a level; one that ROS does not know keeps its number. */
export function levelName(value: number): string {
  return LEVELS.find((level) => level.value === value)?.name ?? `LEVEL ${value}`;
}

/** What is to be seen. */
export interface Filter {
  /** The least level. */
  level: number;
  /** A node's whole name; empty for all. */
  node: string;
  /** A part of the text or of the node's name, in any case; empty for all. */
  text: string;
}

export function passes(entry: Entry, { level, node, text }: Filter): boolean {
  if (entry.level < level || (node !== "" && entry.node !== node)) return false;
  if (text === "") return true;
  const part = text.toLowerCase();
  return entry.text.toLowerCase().includes(part) || entry.node.toLowerCase().includes(part);
}

/** As rospy writes it to a terminal: `[INFO] [1700000000.123456] [/talker]: hello`. */
export function line(entry: Entry): string {
  const micros = String(Math.floor(entry.nsecs / 1000)).padStart(6, "0");
  return `[${levelName(entry.level)}] [${entry.secs}.${micros}] [${entry.node}]: ${entry.text}`;
}

/** The local time of day to the millisecond. */
export function clock({ secs, nsecs }: Pick<Entry, "secs" | "nsecs">): string {
  return `${timeOfDay(secs)}.${String(Math.floor(nsecs / 1e6)).padStart(3, "0")}`;
}
