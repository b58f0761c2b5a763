// What an arrow says of the messages on it.

import { bandwidth, hertz, whole } from "../format";
import type { Rates } from "../model";
import type { Edge } from "./picture";

export interface FlowText {
  /** Beside the arrow; empty while nothing flows. */
  label: string;
  /** In full, for who points at it. */
  title: string;
  /** In pixels: grows slowly, a step for ten times as much. */
  stroke: number;
  idle: boolean;
  drops: boolean;
}

const THIN = 1.25;
const STEP = 0.75;

export function flowText(edge: Edge, rates: Rates): FlowText {
  let messages = 0;
  let bytes = 0;
  let dropping = 0;
  let dropped = 0;
  const counted = edge.publishers.length > 0 ? edge.publishers : edge.subscriptions;
  for (const key of edge.bothWays ? [...edge.publishers, ...edge.subscriptions] : counted) {
    const flow = rates.publishers.get(key) ?? rates.subscriptions.get(key);
    messages += flow?.messages ?? 0;
    bytes += flow?.bytes ?? 0;
  }
  for (const key of edge.subscriptions) {
    dropping += rates.subscriptions.get(key)?.dropped ?? 0;
    dropped += rates.dropped.get(key) ?? 0;
  }
  const rate = messages > 0 ? hertz(messages) : "";
  const parts = [dropping > 0 ? "⚠" : "", rate, edge.latched ? "latched" : ""];
  const words = [`${edge.about}: ${hertz(messages)}`];
  if (bytes > 0) words.push(bandwidth(bytes));
  if (dropped > 0) {
    words.push(
      `${whole(dropped)} dropped since it came${dropping > 0 ? `, ${hertz(dropping)} now` : ""}`,
    );
  }
  return {
    label: parts.filter((part) => part !== "").join(" "),
    title: words.join(", "),
    stroke: Number((THIN + STEP * Math.log10(1 + Math.max(0, messages))).toFixed(2)),
    idle: messages === 0,
    drops: dropping > 0,
  };
}
