/** What is there for the tools' sake, and shown only to who asks for it. */

const NAMES = new Set([
  "/rosout",
  "/rosout_agg",
  "/rosapi",
  "/rosbridge_websocket",
  "/client_count",
  "/connected_clients",
  "/statistics",
]);
const BEGINNINGS = ["/rosapi/", "/rosout/", "/rosbridge_websocket/", "/page_"];
/**
 * What the commands of `fibws` call themselves: with the tool's name, a process id, and a time.
 * Those of `fibws topic` are somebody's publishers and subscribers, as rostopic's are.
 */
const TOOL = /^\/(\w+\/)*fibws_(?!(?:echo|pub|hz|bw|delay)_)[a-z]+_\d+_\d+$/;
const ENDS = ["/get_loggers", "/set_logger_level"];

/** Whether a topic, node or service is of the hub's, a page's or a tool's own making. */
export function isHidden(name: string): boolean {
  return (
    NAMES.has(name) ||
    TOOL.test(name) ||
    BEGINNINGS.some((beginning) => name.startsWith(beginning)) ||
    ENDS.some((end) => name.endsWith(end))
  );
}
