/** Names of nodes, topics and services that are shown only under "Debug". */

const NAMES = new Set([
  "/rosout",
  "/rosout_agg",
  "/rosapi",
  "/rosbridge_websocket",
  "/hub_recorder",
  "/client_count",
  "/connected_clients",
  "/statistics",
]);
const PREFIXES = ["/rosapi/", "/rosout/", "/rosbridge_websocket/", "/hub_recorder/", "/page_"];
/** The logs of hubs that have joined with a prefix, and the nodes of hubs that read logs. */
const OTHER_LOGS = /^\/(\w+\/)+rosout(\/|$)/;
/**
 * The nodes of the commands of `fibws`: `fibws_<command>_<process id>_<digits>`.
 *
 * Those of `fibws topic` are shown: like rostopic's, they are publishers and subscribers that the
 * user started.
 */
const COMMAND = /^\/(\w+\/)*fibws_(?!(?:echo|pub|hz|bw|delay)_)[a-z]+_\d+_\d+$/;
const SUFFIXES = ["/get_loggers", "/set_logger_level"];

/** Whether a name belongs to the hub itself, to a page or to a command. */
export function isHidden(name: string): boolean {
  return (
    NAMES.has(name) ||
    COMMAND.test(name) ||
    OTHER_LOGS.test(name) ||
    PREFIXES.some((prefix) => name.startsWith(prefix)) ||
    SUFFIXES.some((suffix) => name.endsWith(suffix))
  );
}
