/** The form "New topic": opens the page of a topic that does not exist yet. */
import { h, setText } from "../dom";
import type { Model } from "../model";
import type { Place } from "../view";

const COMMON = [
  "std_msgs/Bool",
  "std_msgs/Int32",
  "std_msgs/Float64",
  "std_msgs/String",
  "std_msgs/Empty",
  "geometry_msgs/Point",
  "geometry_msgs/Pose",
  "geometry_msgs/PoseStamped",
  "geometry_msgs/Twist",
  "sensor_msgs/Image",
  "sensor_msgs/JointState",
  "sensor_msgs/LaserScan",
  "nav_msgs/Odometry",
];
const NAME = /^\/?[A-Za-z~][\w~]*(\/\w+)*$/;
const TYPE = /^[A-Za-z]\w*(\/msg)?\/[A-Za-z]\w*$/;

export class NewTopic {
  readonly button: HTMLButtonElement;
  readonly element: HTMLFormElement;
  readonly #model: Model;
  readonly #place: Place;
  readonly #name: HTMLInputElement;
  readonly #type: HTMLInputElement;
  readonly #types = h("datalist", { id: "new-topic-types" });
  readonly #problem = h("p", { class: "error", role: "alert", hidden: true });
  readonly #chosenTypes = new Map<string, string>();

  constructor(model: Model, place: Place) {
    this.#place = place;
    this.#model = model;
    const shared = { autocomplete: "off", spellcheck: "false", class: "mono", required: true };
    this.#name = h("input", { ...shared, placeholder: "/chatter" });
    this.#type = h("input", { ...shared, placeholder: "std_msgs/String", list: "new-topic-types" });
    this.element = h(
      "form",
      {
        class: "new-topic panel padded",
        hidden: true,
        novalidate: true,
        onsubmit: (event: Event) => this.#open(event),
      },
      h("label", { class: "field" }, "Name", this.#name),
      h("label", { class: "field" }, "Type", this.#type),
      this.#types,
      h("button", { type: "submit", class: "primary" }, "Open"),
      this.#problem,
    );
    this.button = h(
      "button",
      {
        type: "button",
        class: "toggle",
        "aria-expanded": "false",
        onclick: () => this.#toggle(this.element.hidden !== false),
      },
      "New topic",
    );
  }

  /** The type that the user chose for a new topic, or an empty string. */
  typeOf(name: string): string {
    return this.#chosenTypes.get(name) ?? "";
  }

  #toggle(open: boolean): void {
    this.element.hidden = !open;
    this.button.setAttribute("aria-expanded", String(open));
    if (!open) {
      this.button.focus();
      return;
    }
    const known = this.#model.graph.value?.topics.map(({ type }) => type) ?? [];
    const types = [...new Set([...known, ...COMMON])].filter((type) => type !== "").sort();
    this.#types.replaceChildren(...types.map((type) => h("option", { value: type })));
    this.#name.focus();
  }

  #open(event: Event): void {
    event.preventDefault();
    const name = this.#name.value.trim();
    const type = this.#type.value.trim();
    const existing = this.#model.graph.value?.topics.find((topic) => topic.name === absolute(name));
    const problem = this.#problemOf(name, type, existing?.type);
    setText(this.#problem, problem);
    this.#problem.hidden = problem === "";
    if (problem !== "") return;
    this.#chosenTypes.set(absolute(name), type);
    this.#toggle(false);
    this.#place.go("topics", absolute(name));
  }

  #problemOf(name: string, type: string, existing: string | undefined): string {
    if (!NAME.test(name))
      return `“${name}” is not a valid topic name; try /chatter or /robot1/cmd_vel.`;
    if (existing)
      return existing === type || type === ""
        ? ""
        : `${absolute(name)} already exists with type ${existing}.`;
    return TYPE.test(type) ? "" : `“${type}” is not a valid type; try std_msgs/String.`;
  }
}

function absolute(name: string): string {
  return name.startsWith("/") ? name : `/${name}`;
}
