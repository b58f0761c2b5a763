/** A button that opens a recording of this computer. */
import { h } from "./dom";
import type { Files } from "./dropped_files";

export function openButton(open: (files: Files) => void): HTMLElement {
  const input = h("input", {
    type: "file",
    accept: ".mcap,.bag,.yaml",
    multiple: true,
    hidden: true,
    "aria-label": "Recording",
    onchange: () => {
      const files = [...(input.files ?? [])];
      if (files[0] !== undefined) open({ name: files[0].name, files });
    },
  });
  const title =
    "Show a recording: an MCAP file, a bag of ROS 1, or all files of a folder of rosbag2; also dropped on the page";
  const button = h(
    "button",
    { type: "button", class: "quiet", title, onclick: () => input.click() },
    "Open file",
  );
  return h("span", { class: "open-file" }, button, input);
}
