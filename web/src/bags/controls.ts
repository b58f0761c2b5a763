/** The header's controls of bags: the hub's recording, and links to the bags that are played. */
import "./bags.css";

import { type Child, h, replace, setText } from "../dom";
import { bytes, plural } from "../format";
import { subscribe } from "../messages/data_client";
import type { Graph, Model, Time } from "../model";
import type { DataSource } from "../source";
import { route } from "../view";
import { clockText } from "./clock_text";
import { downloadUrl, nameOf } from "./download";
import { PLAYBACK, RECORDER } from "./names";

/** A message of fibws_msgs/RecordingState. */
interface RecordingState {
  /** When the message was published. */
  stamp: Time;
  recording: boolean;
  since: Time;
  file: string;
  files: number;
  messages: number;
  bytes: number;
  dropped: number;
  fault: string;
}

export function bagControls(hub: DataSource, model: Model): HTMLElement[] {
  return [playbackLinks(model), recordingControl(hub, model)];
}

/** Links to the topics of the players. */
function playbackLinks(model: Model): HTMLElement {
  const box = h("span", { class: "bags-playbacks" });
  let shown = "";
  model.graph.watch((graph) => {
    const topics = (graph?.topics ?? []).flatMap(({ name, type, publishers }) =>
      type === PLAYBACK && publishers.length > 0 ? [name] : [],
    );
    if (topics.join() === shown) return;
    shown = topics.join();
    const links = topics.map((topic) =>
      h("a", { href: route("topics", topic), title: topic }, "Playback"),
    );
    replace(box, ...links);
  });
  return box;
}

/** A button that starts and stops the hub's recording, and how far that has come. */
function recordingControl(hub: DataSource, model: Model): HTMLElement {
  const progress = h("span", { class: "bags-progress" });
  const problem = h("span", { class: "bags-problem", role: "alert" });
  const button = h(
    "button",
    { type: "button", class: "quiet", id: "record", disabled: true, onclick: () => void toggle() },
    "Record",
  );
  const box = h("span", { id: "recording", hidden: true }, progress, problem, button);
  let isRecording = false;

  const report = (why: string): void => {
    setText(problem, why);
    problem.title = why;
  };

  const show = (state: RecordingState): void => {
    const hasEnded = isRecording && !state.recording;
    isRecording = state.recording;
    button.disabled = false;
    setText(button, isRecording ? "Stop" : "Record");
    button.title = isRecording ? "Stop recording all topics" : "Record all topics at the hub";
    box.classList.toggle("recording", isRecording);
    if (isRecording) setText(progress, progressText(state));
    else if (hasEnded) replace(progress, ...saved(state, hub.url));
    progress.title = [state.file, plural(state.messages, "message")].join(", ");
    report(state.fault);
  };

  const toggle = async (): Promise<void> => {
    button.disabled = true;
    const service = `${RECORDER}/${isRecording ? "stop" : "start"}`;
    try {
      const { success, message } = await hub.call<{ success: boolean; message: string }>(
        service,
        "std_srvs/Trigger",
      );
      report(success ? "" : message);
    } catch (error) {
      report((error as Error).message);
    }
    button.disabled = false;
  };

  subscribe(hub, { topic: `${RECORDER}/state` }, (message) => {
    // These have 64 bits.
    const [messages, bytes, dropped] = ["messages", "bytes", "dropped"].map((name) =>
      Number(message[name]),
    );
    show({ ...message, messages, bytes, dropped } as unknown as RecordingState);
  });
  model.graph.watch((graph) => {
    box.hidden = !canRecord(graph);
  });
  return box;
}

function canRecord(graph: Graph | null): boolean {
  return graph?.services.some(({ name }) => name === `${RECORDER}/start`) ?? false;
}

/**
 * What a recording has left: `saved 2026-11-27.bag · 20 MiB · 5000 messages`.
 *
 * The name is a link that downloads the file, of several the last one; another link shows it.
 */
function saved({ file, files, bytes: size, messages }: RecordingState, hub: string): Child[] {
  if (files === 0) return [];
  const name = nameOf(file);
  const before = files > 1 ? `saved ${plural(files, "file")}, the last one ` : "saved ";
  const url = downloadUrl(file, hub, location.href);
  const link = h("a", { href: url, download: name }, name);
  const facts = [before, link, ["", bytes(size), plural(messages, "message")].join(" · ")];
  // The hub sends files to its own pages alone.
  if (new URL(url).origin !== location.origin) return facts;
  const show = h("a", { href: `?${new URLSearchParams({ file: url })}` }, "Show");
  return [...facts, " · ", show];
}

/** How long and how much: `1:05 · 20 MiB`, and what was dropped. */
export function progressText({ stamp, since, bytes: size, dropped }: RecordingState): string {
  const texts = [clockText(stamp.secs - since.secs), bytes(size)];
  if (dropped > 0) texts.push(`${dropped} dropped`);
  return texts.join(" · ");
}
