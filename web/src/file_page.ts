/** The page of a recording: the views that need no hub, with the time bar. */
import { h, replace, setText } from "./dom";
import type { Files } from "./dropped_files";
import { FileModel, FileSource } from "./file_source";
import { bytes, plural } from "./format";
import type { Origin, RecordingReport } from "./messages/recording_messages";
import { Navigation } from "./navigation";
import { openButton } from "./open_button";
import { TimeBar } from "./timebar/bar";
import { route } from "./view";

const TABS = ["topics", "dashboard", "console"] as const;
type FileTab = (typeof TABS)[number];
const LABELS: Record<FileTab, string> = {
  topics: "Topics",
  dashboard: "Dashboard",
  console: "Console",
};

/** Show a recording in place of the page; return a function that ends that. */
export function showRecording(origin: Origin, open: (files: Files) => void): () => void {
  const source = new FileSource(origin);
  const model = new FileModel(source);
  const stage = h("main", { id: "stage", tabindex: -1 });
  const links = new Map(
    TABS.map((tab) => [tab, h("a", { href: route(tab), id: `tab-${tab}` }, LABELS[tab])]),
  );
  const facts = h("span", { id: "state", role: "status" }, "opening …");
  const box = h("div", { id: "hub" }, h("code", {}, nameOf(origin)), facts);
  const problem = h("section", { class: "problem file-problem", role: "alert", hidden: true });
  replace(
    document.body,
    h(
      "header",
      { id: "header" },
      h("h1", {}, "fibws"),
      box,
      h("nav", { "aria-label": "Views" }, ...links.values()),
      h(
        "div",
        { id: "tools" },
        openButton(open),
        h(
          "button",
          { type: "button", class: "quiet", onclick: () => location.assign(location.pathname) },
          "Close file",
        ),
      ),
    ),
    problem,
    stage,
    new TimeBar(source.clock, source.data, model, true).element,
  );
  const select = (tab: FileTab): void => {
    for (const [name, link] of links) {
      if (name === tab) link.setAttribute("aria-current", "page");
      else link.removeAttribute("aria-current");
    }
    document.title = `${nameOf(origin)} · fibws`;
  };
  const navigation = new Navigation(stage, source, model, TABS, select);
  let isOpen = false;
  source.report.watch((report) => {
    if (report === null) return;
    box.dataset.state = report.fault === "" ? "open" : "closed";
    setText(facts, report.fault === "" ? factsOf(report) : "cannot be shown");
    const problems = report.fault === "" ? report.warnings : [report.fault];
    replace(problem, ...problems.map((each) => h("p", {}, `${each.replace(/\.$/, "")}.`)));
    problem.hidden = problems.length === 0;
    if (!isOpen && report.fault === "") void navigation.navigate();
    isOpen = true;
  });
  return () => {
    navigation.end();
    source.data.close();
  };
}

function factsOf({ size, topics }: RecordingReport): string {
  return `${bytes(size)}, ${plural(topics.length, "topic")}`;
}

function nameOf(origin: Origin): string {
  if ("name" in origin) return origin.name;
  return decodeURIComponent(new URL(origin.url).pathname.split("/").at(-1) ?? origin.url);
}
