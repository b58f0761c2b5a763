/** The Console tab: the messages that nodes log, newest at the bottom. */
import { append } from "../lists";
import "./console.css";

import { copyButton } from "../copy_button";
import { h, replace, setText } from "../dom";
import { Filter, FilterInput } from "../filter";
import { plural, whole } from "../format";
import type { Model } from "../model";
import type { MakeView, Place, View } from "../view";
import {
  clock,
  type Entry,
  type EntryFilter,
  LEVELS,
  type Log,
  levelName,
  line,
  MAX_ENTRIES,
  passes,
  WARN,
} from "./log";

/** How many names the list of nodes has at most. */
const MAX_NAMES = 500;
/** The list counts as scrolled to its end up to this distance, in px. */
const AT_END = 8;

export const makeView: MakeView = (_hub, model, place) => new ConsoleView(model, place.save);

export class ConsoleView implements View {
  readonly element: HTMLElement;
  readonly #log: Log;
  readonly #saveState: Place["save"];
  readonly #filter: EntryFilter = { level: 0, node: "", text: new Filter() };
  readonly #rows = h("ol", { class: "log" });
  readonly #scroller = h("div", {
    class: "scroll",
    tabindex: 0,
    role: "log",
    "aria-live": "off",
    "aria-label": "Messages",
  });
  readonly #nodes = h("select", { "aria-label": "Node" }, h("option", { value: "" }, "all nodes"));
  readonly #level = h(
    "select",
    { "aria-label": "Minimum level" },
    h("option", { value: 0 }, "all levels"),
    ...LEVELS.slice(1).map(({ value, name }, index, { length }) =>
      h("option", { value }, index === length - 1 ? name : `${name} and above`),
    ),
  );
  readonly #text = new FilterInput("Filter messages", () =>
    this.#choose({ text: this.#text.filter }),
  );
  readonly #names = new Set<string>();
  readonly #note = h("p", { class: "soft small", role: "status" });
  readonly #pause = h("button", { type: "button" }, "Pause");
  readonly #newest = h(
    "button",
    { type: "button", class: "to-end primary", hidden: true },
    "Jump to newest",
  );
  #shown: Entry[] = [];
  /** The number of the newest entry that was drawn or filtered out. */
  #drawn = 0;
  #paused = false;
  #following = true;
  #stop: (() => void) | undefined;

  /** `save` is called with the state that belongs into the URL. */
  constructor({ log }: Model, save: Place["save"]) {
    this.#log = log;
    this.#saveState = save;
    this.#scroller.append(this.#rows);
    this.#scroller.addEventListener("scroll", () => this.#scrolled(), { passive: true });
    this.#pause.addEventListener("click", () => this.#setPaused(!this.#paused));
    this.#newest.addEventListener("click", () => this.#follow());
    this.element = h(
      "section",
      { class: "console", "aria-label": "Console" },
      this.#toolbar(),
      h("div", { class: "frame" }, this.#scroller, this.#newest),
      this.#note,
    );
  }

  show(_path: string[], state: URLSearchParams | null): void {
    if (state !== null) this.#restore(state);
    this.#save();
    this.#log.setVisible(true);
    if (this.#stop === undefined) {
      const stops = [
        this.#log.newest.watch(() => this.#draw()),
        this.#log.cleared.watch(() => this.#redraw()),
      ];
      this.#stop = () => {
        for (const stop of stops) stop();
      };
    }
    if (this.#following) this.#follow();
  }

  hide(): void {
    this.#log.setVisible(false);
    this.#stop?.();
    this.#stop = undefined;
  }

  #toolbar(): HTMLElement {
    this.#level.addEventListener("change", () =>
      this.#choose({ level: Number(this.#level.value) }),
    );
    this.#nodes.addEventListener("change", () => this.#choose({ node: this.#nodes.value }));
    const clear = h("button", { type: "button" }, "Clear");
    clear.addEventListener("click", () => this.#log.clear());
    return h(
      "div",
      { class: "toolbar" },
      this.#level,
      this.#nodes,
      this.#text.element,
      this.#pause,
      clear,
      copyButton("Copy", () => this.#shown.map(line).join("\n")),
    );
  }

  #choose(change: Partial<EntryFilter>): void {
    Object.assign(this.#filter, change);
    this.#save();
    this.#redraw();
  }

  /** `?level=warn&node=/talker&filter=motor` */
  #save(): void {
    const { level, node, text } = this.#filter;
    this.#saveState({
      level: level === 0 ? "" : levelName(level).toLowerCase(),
      node,
      filter: text.text,
    });
  }

  #restore(state: URLSearchParams): void {
    const level = state.get("level")?.toUpperCase();
    this.#text.text = state.get("filter") ?? "";
    Object.assign(this.#filter, {
      level: LEVELS.slice(1).find(({ name }) => name === level)?.value ?? 0,
      node: state.get("node") ?? "",
      text: this.#text.filter,
    });
    // The node may not have logged yet.
    if (this.#filter.node !== "") this.#addNode(this.#filter.node);
    this.#level.value = String(this.#filter.level);
    this.#nodes.value = this.#filter.node;
    this.#redraw();
  }

  #redraw(): void {
    replace(this.#rows);
    this.#shown = [];
    this.#drawn = 0;
    // Even while paused: the filter applies to what is shown.
    this.#appendNew();
    this.#follow();
  }

  #setPaused(paused: boolean): void {
    this.#paused = paused;
    this.#pause.classList.toggle("on", paused);
    setText(this.#pause, paused ? "Resume" : "Pause");
    this.#draw();
  }

  #draw(): void {
    if (this.#paused) this.#showStatus(this.#log.after(this.#drawn).length);
    else this.#appendNew();
  }

  #appendNew(): void {
    const entries = this.#log.after(this.#drawn);
    this.#append(entries.filter((entry) => passes(entry, this.#filter)));
    this.#drawn = entries.at(-1)?.number ?? this.#drawn;
    for (const { node } of entries) this.#addNode(node);
    this.#showStatus(0);
  }

  #append(entries: Entry[]): void {
    if (entries.length === 0) return;
    this.#rows.append(...entries.map(row));
    append(this.#shown, entries);
    const excess = this.#shown.length - MAX_ENTRIES;
    if (excess > 0) {
      this.#shown.splice(0, excess);
      for (let gone = 0; gone < excess; gone += 1) this.#rows.firstElementChild?.remove();
    }
    if (this.#following) this.#scroller.scrollTop = this.#scroller.scrollHeight;
  }

  #addNode(name: string): void {
    if (this.#names.has(name) || this.#names.size >= MAX_NAMES) return;
    this.#names.add(name);
    this.#nodes.append(h("option", { value: name }, name));
  }

  #showStatus(waiting: number): void {
    const count = this.#shown.length;
    const filtered =
      this.#filter.level > 0 || this.#filter.node !== "" || !this.#filter.text.isEmpty;
    let text = plural(count, "line");
    if (count === 0) {
      text = filtered ? "No lines match the filter." : "No messages since this page was opened.";
    } else if (count === MAX_ENTRIES) {
      text = `The newest ${whole(MAX_ENTRIES)} lines; older lines are discarded.`;
    }
    if (this.#paused) text += ` Paused: ${whole(waiting)} more.`;
    setText(this.#note, text);
  }

  #scrolled(): void {
    const { scrollTop, scrollHeight, clientHeight } = this.#scroller;
    this.#following = scrollTop + clientHeight >= scrollHeight - AT_END;
    this.#newest.hidden = this.#following;
  }

  #follow(): void {
    this.#following = true;
    this.#newest.hidden = true;
    this.#scroller.scrollTop = this.#scroller.scrollHeight;
  }
}

function row(entry: Entry): HTMLElement {
  const name = levelName(entry.level);
  // Warnings and errors show their source; other messages only in the tooltip.
  const where = entry.level >= WARN && entry.where !== "";
  return h(
    "li",
    { class: `level-${name.toLowerCase()}`, title: entry.where || null },
    h("time", {}, clock(entry)),
    h("span", { class: "level" }, name),
    h("span", { class: "node", title: entry.node }, entry.node),
    h("span", { class: "text" }, entry.text, where && h("small", {}, entry.where)),
  );
}
