/** The names by which the page finds recorders and players of bags. */

/** The hub's node that records. */
export const RECORDER = "/hub_recorder";
/** The type of the topics on which players publish their state. */
export const PLAYBACK = "fibws_msgs/PlaybackState";
