/** A layout made from what there is in the graph. */
import { isHidden } from "../hidden_names";
import type { Graph, TopicInfo } from "../model";
import { joined, type Layout, newPane } from "./layout";
import { VIEWS } from "./views";

/** How many topics are echoed in a graph without anything to look at. */
const MAX_ECHOES = 3;

/**
 * The camera beside the scene or the map, over the stick and the diagnostics: whatever there is.
 *
 * A graph without any of these has echoes of its first topics, and the console; null for an empty one.
 */
export function autoLayout(graph: Graph, canPublish = true): Layout | null {
  const pane = (name: string, rank: (topic: TopicInfo) => number): Layout | null => {
    const view = VIEWS.find((each) => each.name === name);
    const offers = view?.offers(graph) ?? [];
    const best = offers
      .map((offer) => {
        const topic = graph.topics.find((each) => each.name === offer);
        return { offer, rank: topic === undefined ? 0 : rank(topic) };
      })
      .sort((one, other) => other.rank - one.rank)[0];
    return best === undefined ? null : newPane(name, best.offer);
  };
  const published = ({ publishers }: TopicInfo): number => Number(publishers.length > 0);
  const camera = pane(
    "image",
    // The smaller of two topics with the same images.
    (topic) => 2 * published(topic) + Number(topic.type.endsWith("/CompressedImage")),
  );
  const space = pane("3d", published) ?? pane("map", published) ?? pane("transforms", published);
  // A topic that moves a robot has a subscriber other than a page.
  const isDriven = ({ subscriptions }: TopicInfo): number =>
    Number(subscriptions.some(({ node }) => !isHidden(node)));
  const drive = canPublish ? pane("teleop", isDriven) : null;
  const diagnostics = pane("diagnostics", (topic) => Number(topic.name.endsWith("_agg")));
  const top = joined("row", [camera, space], 0.6);
  const bottom = joined("row", [drive, diagnostics], 0.4);
  const robot = joined("col", [top, bottom]);
  if (robot !== null) return robot;
  const topics = VIEWS.find(({ name }) => name === "raw")?.offers(graph) ?? [];
  if (topics.length === 0) return null;
  const echoes = topics.slice(0, MAX_ECHOES).map((name) => newPane("raw", name));
  return joined("col", [joined("row", echoes, 0.6), { ...newPane("console"), size: 0.4 }]);
}
