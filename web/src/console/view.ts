/** What the nodes say, the newest at the bottom. */
import "./console.css";

import { copyButton } from "../copy";
import { h, replace, say } from "../dom";
import { plural, whole } from "../format";
import type { Model } from "../model";
import type { MakeView, View } from "../view";
import { clock, type Entry, type Filter, LEVELS, levelName, line, passes } from "./entry";
import { GRAVE, type Log, ROOM } from "./log";

/** Names that one can choose from. */
const MOST_NAMES = 500;
/** How near to its end a list counts as scrolled to the end, in px. */
const NEAR = 8;

export const makeView: MakeView = (_hub, model) => new ConsoleView(model);

class ConsoleView implements View {
  readonly element: HTMLElement;
  readonly #log: Log;
  readonly #filter: Filter = { level: 0, node: "", text: "" };
  readonly #rows = h("ol", { class: "log" });
  readonly #scroller = h("div", {
    class: "scroll",
    tabindex: 0,
    role: "log",
    "aria-live": "off",
    "aria-label": "What the nodes say",
  });
  readonly #nodes = h("select", { "aria-label": "Node" }, h("option", { value: "" }, "all nodes"));
  readonly #names = new Set<string>();
  readonly #note = h("p", { class: "soft small", role: "status" });
  readonly #pause = h("button", { type: "button" }, "Pause");
  readonly #newest = h(
    "button",
    { type: "button", class: "to-end primary", hidden: true },
    "To the newest",
  );
  #shown: Entry[] = [];
  /** The number of the newest entry that was drawn, or filtered out. */
  #drawn = 0;
  #paused = false;
  #following = true;
  #stop: (() => void) | undefined;

  constructor({ log }: Model) {
    this.#log = log;
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

  show(): void {
    this.#log.look(true);
    this.#stop ??= this.#log.newest.watch(() => this.#draw());
    if (this.#following) this.#follow();
  }

  hide(): void {
    this.#log.look(false);
    this.#stop?.();
    this.#stop = undefined;
  }

  #toolbar(): HTMLElement {
    const level = h(
      "select",
      { "aria-label": "Least level" },
      h("option", { value: 0 }, "all levels"),
      ...LEVELS.slice(1).map(({ value, name }, index, { length }) =>
        h("option", { value }, index === length - 1 ? name : `${name} and above`),
      ),
    );
    level.addEventListener("change", () => this.#choose({ level: Number(level.value) }));
    this.#nodes.addEventListener("change", () => this.#choose({ node: this.#nodes.value }));
    const text = h("input", {
      type: "search",
      "aria-label": "Text",
      placeholder: "text or node",
      class: "grow",
    });
    text.addEventListener("input", () => this.#choose({ text: text.value }));
    const clear = h("button", { type: "button" }, "Clear");
    clear.addEventListener("click", () => this.#clear());
    return h(
      "div",
      { class: "toolbar" },
      level,
      this.#nodes,
      text,
      this.#pause,
      clear,
      copyButton("Copy", () => this.#shown.map(line).join("\n")),
    );
  }

  #choose(change: Partial<Filter>): void {
    Object.assign(this.#filter, change);
    this.#redraw();
  }

  #clear(): void {
    this.#log.clear();
    this.#redraw();
  }

  #redraw(): void {
    replace(this.#rows);
    this.#shown = [];
    this.#drawn = 0;
    // Paused or not: what stands there is to pass the filter.
    this.#take();
    this.#follow();
  }

  #setPaused(paused: boolean): void {
    this.#paused = paused;
    this.#pause.classList.toggle("on", paused);
    say(this.#pause, paused ? "Go on" : "Pause");
    this.#draw();
  }

  #draw(): void {
    if (this.#paused) this.#tell(this.#log.after(this.#drawn).length);
    else this.#take();
  }

  #take(): void {
    const entries = this.#log.after(this.#drawn);
    this.#append(entries.filter((entry) => passes(entry, this.#filter)));
    this.#drawn = entries.at(-1)?.number ?? this.#drawn;
    for (const { node } of entries) this.#offer(node);
    this.#tell(0);
  }

  #append(entries: Entry[]): void {
    if (entries.length === 0) return;
    this.#rows.append(...entries.map(row));
    this.#shown.push(...entries);
    const excess = this.#shown.length - ROOM;
    if (excess > 0) {
      this.#shown.splice(0, excess);
      for (let gone = 0; gone < excess; gone += 1) this.#rows.firstElementChild?.remove();
    }
    if (this.#following) this.#scroller.scrollTop = this.#scroller.scrollHeight;
  }

  #offer(name: string): void {
    if (this.#names.has(name) || this.#names.size >= MOST_NAMES) return;
    this.#names.add(name);
    this.#nodes.append(h("option", { value: name }, name));
  }

  #tell(waiting: number): void {
    const count = this.#shown.length;
    const filtered = this.#filter.level > 0 || this.#filter.node !== "" || this.#filter.text !== "";
    let text = plural(count, "line");
    if (count === 0) {
      text = filtered
        ? "Nothing passes the filter."
        : "Nothing has been said yet since this page was opened.";
    } else if (count === ROOM) {
      text = `The newest ${whole(ROOM)} lines; older ones are let go.`;
    }
    if (this.#paused) text += ` Paused: ${whole(waiting)} more.`;
    say(this.#note, text);
  }

  #scrolled(): void {
    const { scrollTop, scrollHeight, clientHeight } = this.#scroller;
    this.#following = scrollTop + clientHeight >= scrollHeight - NEAR;
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
  // Of what is wrong one wants to know where; of the rest only if one asks.
  const where = entry.level >= GRAVE && entry.where !== "";
  return h(
    "li",
    { class: `level-${name.toLowerCase()}`, title: entry.where || null },
    h("time", {}, clock(entry)),
    h("span", { class: "level" }, name),
    h("span", { class: "node" }, entry.node),
    h("span", { class: "text" }, entry.text, where && h("small", {}, entry.where)),
  );
}
