/** The links to other hubs, with their rates. */
import type { Time } from "../model";

export interface HubInfo {
  id: string;
  name: string;
  version: string;
  /** The hub by way of which it is reached. */
  link: string;
  distance: number;
  nodes: number;
}

export interface HubLink {
  kind: string;
  /** Empty for those who may not see it. */
  address: string;
  name: string;
  id: string;
  version: string;
  /** Why it is not connected; empty while it is. */
  fault: string;
  since: Time;
  /** In seconds, as is the offset. */
  round_trip: number;
  clock_offset: number;
  messages_sent: number;
  messages_received: number;
  bytes_sent: number;
  bytes_received: number;
  dropped: number;
  lost: number;
}

/** A response of /rosapi/hubs. */
export interface Hubs {
  stamp: Time;
  hub: HubInfo;
  links: HubLink[];
  hubs: HubInfo[];
}

/** Per second. */
export interface LinkRates {
  messagesIn: number;
  messagesOut: number;
  bytesIn: number;
  bytesOut: number;
}

/** The rates of a link between two responses; null if it was not there before. */
export function ratesOf(link: HubLink, now: Hubs, before: Hubs | null): LinkRates | null {
  const older = before?.links.find(
    ({ id, kind, since }) =>
      id === link.id &&
      kind === link.kind &&
      since.secs === link.since.secs &&
      since.nsecs === link.since.nsecs,
  );
  if (before === null || older === undefined) return null;
  const seconds = now.stamp.secs - before.stamp.secs + (now.stamp.nsecs - before.stamp.nsecs) / 1e9;
  if (!(seconds > 0)) return null;
  return {
    messagesIn: (link.messages_received - older.messages_received) / seconds,
    messagesOut: (link.messages_sent - older.messages_sent) / seconds,
    bytesIn: (link.bytes_received - older.bytes_received) / seconds,
    bytesOut: (link.bytes_sent - older.bytes_sent) / seconds,
  };
}
