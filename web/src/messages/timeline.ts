/** Keeps what the page shows, and shows it again; it runs in the worker. */
import type { Feed } from "./feed";
import { History } from "./history";
import { Player } from "./player";
import type { ClockReport } from "./worker_messages";

/** Bytes of messages that are kept: a quarter of them on devices with little memory. */
const LIMIT = 256 * 2 ** 20;
/** Such devices have so many GiB at most. */
const SMALL = 2;

/** From now on keep the messages of a feed; return what shows them again. */
export function keep(feed: Feed, post: (report: ClockReport) => void): Player {
  const { deviceMemory = Infinity } = navigator as { deviceMemory?: number };
  const history = new History(deviceMemory <= SMALL ? LIMIT / 4 : LIMIT);
  const player = new Player(history, true, () => feed.takers, post);
  feed.player = {
    get isLive() {
      return player.isLive;
    },
    add: (taker) => player.add(taker),
    record: (message) => history.add(message),
  };
  return player;
}
