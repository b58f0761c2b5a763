/** Shows the tree of coordinate frames, what is wrong with it, and where one frame is in another. */
import "./frames.css";

import { h, replace, setText } from "../../dom";
import { hertz, plural } from "../../format";
import { KeyedRows } from "../../keyed_rows";
import { subscribe } from "../../messages/data_client";
import { fixedText } from "../../messages/values";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import { rollPitchYaw, type TransformStamped } from "../../transforms";
import type { Config, Panel } from "../panel";
import { type Frame, Frames, MAX_FRAMES } from "./frames";

/** Time between two updates, in ms. */
const TICK = 250;
/** How many messages wait: each may be about other frames. */
const QUEUE = 1000;

export function makePanel(
  hub: DataSource,
  _model: Model,
  topic: string,
  _type: string,
  config?: Config,
): Panel {
  return new FramesPanel(hub, topic, config);
}

/** One frame on the page. */
interface Row {
  readonly element: HTMLElement;
  readonly facts: HTMLElement;
  readonly faults: HTMLElement;
  readonly children: Tree;
}

/** Some frames below another one, or the roots. */
type Tree = KeyedRows<string, Row>;

class FramesPanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #topics: readonly string[];
  readonly #frames = new Frames();
  readonly #counts = h("p", { class: "frames-counts", role: "status" });
  readonly #list = h("ul", { class: "frames-tree", "aria-label": "Frames" });
  readonly #tree: Tree = new KeyedRows(this.#list, (name) => this.#row(name));
  readonly #target = this.#select("In the frame");
  readonly #source = this.#select("Where the frame is");
  readonly #transform = h("table", { class: "frames-transform mono" });
  readonly #lookupFault = h("p", { class: "small soft", role: "status" });
  readonly #lookup: HTMLElement;
  readonly #empty = h("p", { class: "soft" }, "No transform yet.");
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  /** The frames that the user has chosen, which may not have been received yet. */
  #chosen: Config;
  #names = "";
  #stops: (() => void)[] = [];
  #timer: number | undefined;

  constructor(hub: DataSource, topic: string, config: Config = {}) {
    this.#hub = hub;
    this.#chosen = config;
    // The tree is in both topics of a namespace.
    const base = /^(.*\/tf)(_static)?$/.exec(topic)?.[1];
    this.#topics = base === undefined ? [topic] : [base, `${base}_static`];
    this.#lookup = h(
      "div",
      { class: "frames-lookup", hidden: true },
      h("div", { class: "toolbar" }, h("span", {}, "Where is"), this.#source, "in", this.#target),
      this.#lookupFault,
      this.#transform,
    );
    this.element = h(
      "div",
      { class: "frames" },
      this.#counts,
      this.#error,
      this.#empty,
      this.#list,
      this.#lookup,
    );
  }

  show(): void {
    if (this.#stops.length > 0) return;
    const streams = this.#topics.map((topic) =>
      subscribe(
        this.#hub,
        { topic, queue: QUEUE, headers: true },
        ({ transforms }, { node, time }) => {
          const source = { node, isStatic: topic.endsWith("_static") };
          this.#frames.update(transforms as TransformStamped[], source, time);
        },
        (why) => {
          setText(this.#error, `${topic}: ${why}`);
          this.#error.hidden = why === "";
        },
      ),
    );
    this.#stops = [...streams, this.#hub.clock.onJump(() => this.#frames.clear())];
    this.#timer = window.setInterval(() => this.#show(), TICK);
  }

  hide(): void {
    for (const stop of this.#stops) stop();
    this.#stops = [];
    window.clearInterval(this.#timer);
  }

  config(): Config {
    return this.#chosen;
  }

  #select(label: string): HTMLSelectElement {
    return h("select", {
      class: "mono",
      "aria-label": label,
      onchange: () => this.#choose(),
    });
  }

  #show(): void {
    const now = this.#hub.clock.now();
    this.#frames.age(now);
    const { all, names } = this.#frames;
    this.#empty.hidden = all.size > 0;
    this.#lookup.hidden = all.size === 0;
    if (all.size === 0) return;
    const roots = this.#frames.roots();
    const faulty = [...all.values()].filter(
      (frame) => this.#frames.faultsOf(frame, now).length > 0,
    );
    const parts = [
      plural(names.length, "frame"),
      plural(roots.length, "tree"),
      faulty.length === 0 ? "nothing wrong" : `${faulty.length} with a fault`,
      ...(all.size >= MAX_FRAMES ? [`only ${MAX_FRAMES} are shown`] : []),
    ];
    setText(this.#counts, parts.join(" · "));
    this.#showTree(this.#tree, roots, now, new Set());
    this.#offer(names);
    this.#showTransform();
  }

  /** Show some frames and those below them; `above` are those that a loop would come back to. */
  #showTree(tree: Tree, names: readonly string[], now: number, above: ReadonlySet<string>): void {
    tree.show(names);
    for (const [name, row] of tree.entries()) {
      const frame = this.#frames.all.get(name);
      setText(row.facts, frame === undefined ? "" : factsOf(frame, now));
      const faults = frame === undefined ? [] : this.#frames.faultsOf(frame, now);
      setText(row.faults, faults.map((fault) => `⚠ ${fault}`).join(" "));
      const path = new Set(above).add(name);
      const children = this.#frames.childrenOf(name).map((child) => child.name);
      this.#showTree(
        row.children,
        children.filter((child) => !path.has(child)),
        now,
        path,
      );
    }
  }

  #row(name: string): Row {
    const facts = h("span", { class: "soft small" });
    const faults = h("span", { class: "frames-faults small" });
    const list = h("ul", {});
    const choose = (): void => {
      this.#source.value = name;
      this.#choose();
    };
    const element = h(
      "li",
      {},
      h(
        "button",
        { type: "button", class: "quiet mono", title: "Where is it?", onclick: choose },
        name,
      ),
      " ",
      facts,
      " ",
      faults,
      list,
    );
    const children: Tree = new KeyedRows(list, (each) => this.#row(each));
    return { element, facts, faults, children };
  }

  /** Offer the frames in the two lists; the first choice is the robot's base in its root. */
  #offer(names: readonly string[]): void {
    const text = names.join();
    if (text === this.#names) return;
    this.#names = text;
    const root = this.#frames.roots()[0] ?? "";
    const base = names.find((name) => /base_(link|footprint)$/.test(name)) ?? names.at(-1) ?? "";
    for (const [select, key, first] of [
      [this.#target, "target", root],
      [this.#source, "source", base],
    ] as const) {
      const wanted = String(this.#chosen[key] ?? select.value);
      const chosen = names.includes(wanted) ? wanted : first;
      replace(select, ...names.map((name) => h("option", { value: name }, name)));
      select.value = chosen;
    }
  }

  #choose(): void {
    this.#chosen = { target: this.#target.value, source: this.#source.value };
    this.#showTransform();
  }

  #showTransform(): void {
    let found: ReturnType<Frames["lookup"]>;
    try {
      found = this.#frames.lookup(this.#target.value, this.#source.value);
    } catch (error) {
      setText(this.#lookupFault, (error as Error).message);
      this.#transform.hidden = true;
      return;
    }
    setText(this.#lookupFault, "");
    this.#transform.hidden = false;
    const { translation, rotation } = found;
    const angles = rollPitchYaw(rotation);
    const rows: [label: string, numbers: number[], unit: string][] = [
      ["x, y, z", [translation.x, translation.y, translation.z], "m"],
      ["roll, pitch, yaw", angles.map((each) => (each * 180) / Math.PI), "°"],
      ["", angles, "rad"],
      ["x, y, z, w", [rotation.x, rotation.y, rotation.z, rotation.w], ""],
    ];
    replace(
      this.#transform,
      ...rows.map(([label, numbers, unit]) =>
        h(
          "tr",
          {},
          h("th", { scope: "row" }, label),
          ...numbers.map((each) => h("td", {}, fixedText(each, unit === "°" ? 1 : 3))),
          numbers.length < 4 && h("td", {}, unit),
        ),
      ),
    );
  }
}

function factsOf({ isStatic, rate, arrived, node }: Frame, now: number): string {
  const age = now - arrived;
  const parts = isStatic ? ["static"] : [hertz(rate), `${Math.round(age)} ms ago`];
  if (node !== "") parts.push(node);
  return parts.join(" · ");
}
