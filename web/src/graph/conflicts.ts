/** Who uses a topic, and which of them exchange no messages since their types differ. */

import type { ConflictInfo, Graph, TopicInfo } from "../model";

/** Stands for the type of a conflict that has another reason, such as a missing right. */
export const NO_MESSAGES = "no messages";

export interface TopicUser {
  node: string;
  /** The type with which it uses the topic; `*` for any. */
  type: string;
  publishes: boolean;
  latch: boolean;
  /** Whether it is a ROS 1 node, which exchanges messages with others directly. */
  isRos1: boolean;
  conflict: ConflictInfo | null;
}

export class TopicUsers {
  readonly #ros1: ReadonlySet<string>;

  constructor(graph: Graph) {
    this.#ros1 = new Set(graph.nodes.filter(({ api }) => api !== "").map(({ name }) => name));
  }

  /** All users of a topic, those with a conflict last. */
  of(topic: TopicInfo): TopicUser[] {
    const { publishers, subscriptions, conflicts } = topic;
    const user = (
      node: string,
      publishes: boolean,
      latch = false,
      conflict: ConflictInfo | null = null,
    ): TopicUser => ({
      node,
      type: conflict?.type ?? topic.type,
      publishes,
      latch,
      isRos1: this.#ros1.has(node),
      conflict,
    });
    return [
      ...publishers.map(({ node, latch }) => user(node, true, latch)),
      ...subscriptions.map(({ node }) => user(node, false)),
      ...conflicts.map((each) => user(each.node, each.publishes, false, each)),
    ];
  }

  /** Whether ROS 1 nodes publish a topic to ROS 1 nodes. */
  isDirect(topic: TopicInfo): boolean {
    const ros1 = this.of(topic).filter(({ isRos1 }) => isRos1);
    return ros1.some(({ publishes }) => publishes) && ros1.some(({ publishes }) => !publishes);
  }

  /** The conflict that keeps a publisher's messages from a subscriber of the topic, if any. */
  conflict(publisher: TopicUser, subscriber: TopicUser, topic: TopicInfo): ConflictInfo | null {
    const types = new Set([publisher, subscriber].map(definition));
    // Nodes of the same other type exchange messages, and ROS 1 nodes whatever the hub lacks.
    const isOther = [publisher, subscriber].every(
      (user) => isOtherType(user, topic) || (user.conflict?.md5sum ?? "") !== "",
    );
    const isDirect = publisher.isRos1 && subscriber.isRos1;
    if ((isOther || isDirect) && types.size === 1) return null;
    if (isDirect && types.has("* ")) return null;
    return publisher.conflict ?? subscriber.conflict;
  }
}

/** The type that a node uses: two of one name may have other fields. */
function definition({ type, conflict }: TopicUser): string {
  return `${type} ${conflict?.md5sum ?? ""}`;
}

/** A sentence about a conflict, without its node: `publishes a/B, the topic is c/D`. */
export function conflictText({ type, publishes, fault }: ConflictInfo, topic: TopicInfo): string {
  const verb = publishes ? "publishes" : "subscribes to";
  return isOtherType({ type }, topic)
    ? `${verb} ${type}, the topic is ${topic.type}`
    : `${verb} ${type}: ${fault}`;
}

/** Whether it is the type that keeps messages from passing. */
export function isOtherType({ type }: { type: string }, topic: TopicInfo): boolean {
  return topic.type !== "" && type !== topic.type;
}
