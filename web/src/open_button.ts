/** A button that opens a recording of this computer. */
import { h } from "./dom";

export function openButton(open: (file: File) => void): HTMLElement {
  const input = h("input", {
    type: "file",
    accept: ".mcap,.bag",
    hidden: true,
    "aria-label": "Recording",
    onchange: () => {
      const [file] = input.files ?? [];
      if (file !== undefined) open(file);
    },
  });
  const title = "Show a recording: an MCAP file or a bag of ROS 1, also dropped on the page";
  const button = h(
    "button",
    { type: "button", class: "quiet", title, onclick: () => input.click() },
    "Open file",
  );
  return h("span", {}, button, input);
}
