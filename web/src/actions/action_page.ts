/** The page of one action: a form for the goal, and the goals that were sent with it. */
import { browsePage } from "../browse";
import { h, replace, setText } from "../dom";
import { MessageForm } from "../form/message_form";
import { plural, timeOfDay } from "../format";
import { MessageTree, type PlotPath } from "../message_tree";
import type { ActionInfo, Model } from "../model";
import type { DataSource } from "../source";
import type { Plot } from "../topics/plot";
import { Types } from "../types";
import { route } from "../view";
import {
  type Goal,
  type GoalSender,
  isFinal,
  OperationSender,
  type Status,
  TopicSender,
} from "./goals";
import "./actions.css";

/** How many goals are shown; older ones are removed once they have ended. */
const MAX_GOALS = 20;

/** The statuses that usually follow. */
const AHEAD: Partial<Record<Status, readonly Status[]>> = {
  PENDING: ["ACTIVE", "SUCCEEDED"],
  ACTIVE: ["SUCCEEDED"],
  PREEMPTING: ["PREEMPTED"],
  RECALLING: ["RECALLED"],
};

/** What is known of what a goal's server sends; types are undefined while they are unknown. */
interface ServerTypes {
  feedback: Types | undefined;
  result: Types | undefined;
  /** Plots a number of the feedback, if that is possible. */
  plot: PlotPath | undefined;
}

export class ActionPage {
  readonly element: HTMLElement;
  readonly name: string;
  readonly type: string;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #overTopics: boolean;
  readonly #node = h("p", { class: "soft small" });
  readonly #fields = h("div", { class: "browse-body" });
  readonly #button = h("button", { type: "submit", class: "primary", disabled: true }, "Send goal");
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  readonly #plotPlace = h("div", { class: "goals-plot" });
  readonly #list = h("ol", { class: "goals", "aria-label": "Goals" });
  readonly #types: ServerTypes = { feedback: undefined, result: undefined, plot: undefined };
  #goals: GoalBox[] = [];
  #count = 0;
  #form: MessageForm | undefined;
  #sender: GoalSender | undefined;
  #shownNode: string | undefined;
  #plot: Plot | undefined;
  #isShown = false;

  /** `plot` plots a number of the feedback; by default, in a plot on the page itself. */
  constructor(
    hub: DataSource,
    model: Model,
    { name, type, over_topics }: Omit<ActionInfo, "node">,
    plot?: (topic: string, path: string) => void,
  ) {
    this.#hub = hub;
    this.#model = model;
    this.name = name;
    this.type = type;
    this.#overTopics = over_topics;
    // Only feedback over topics can be subscribed to.
    if (over_topics) {
      const add = plot ?? ((topic, path) => void this.#plotHere(topic, path));
      this.#types.plot = (path) => add(`${name}/feedback`, `feedback.${path}`);
    }
    this.element = browsePage(
      name,
      "actions",
      h("code", { class: "soft" }, type),
      this.#node,
      h(
        "form",
        {
          class: "browse-body",
          novalidate: true,
          "aria-label": `Send a goal to ${name}`,
          onsubmit: (event: Event) => {
            event.preventDefault();
            this.#send();
          },
        },
        this.#fields,
        h("div", { class: "toolbar" }, this.#button),
      ),
      this.#error,
      this.#plotPlace,
      this.#list,
    );
    if (type !== "") void this.#loadTypes();
    else if (over_topics) this.#showError("The type of this action is unknown so far.");
  }

  /** Whether goals that have not ended are shown. */
  get isActive(): boolean {
    return this.#goals.some(({ goal }) => !goal.isFinal);
  }

  /** Show the node that provides the action, if there is one. */
  showNode(node: string | undefined, known: boolean): void {
    if (this.#shownNode === `${node} ${known}`) return;
    this.#shownNode = `${node} ${known}`;
    const transport = this.#overTopics ? "over topics" : "over operations";
    if (node)
      replace(
        this.#node,
        `${transport}, provided by `,
        h("a", { class: "mono", href: route("graph", "node", node) }, node),
      );
    else setText(this.#node, known ? "No node provides this action now." : "Waiting for the hub …");
  }

  /** The page becomes visible. */
  show(): void {
    this.#isShown = true;
    this.#plot?.show("", null);
  }

  /** The page becomes hidden: goals are still followed, and nothing is drawn. */
  hide(): void {
    this.#isShown = false;
    this.#plot?.hide();
  }

  /** Stop following the goals, and remove the plot; the next goal is followed again. */
  close(): void {
    this.#plot?.close();
    this.#plot = undefined;
    replace(this.#plotPlace);
    this.#sender?.close();
    this.#sender = undefined;
  }

  async #plotHere(topic: string, path: string): Promise<void> {
    const { Plot } = await import("../topics/plot");
    if (this.#plot === undefined) {
      this.#plot = new Plot(this.#hub, this.#model, () => undefined);
      replace(this.#plotPlace, this.#plot.element);
      if (this.#isShown) this.#plot.show("", null);
    }
    this.#plot.add(topic, path);
  }

  async #loadTypes(): Promise<void> {
    const part = async (name: string): Promise<Types> =>
      new Types(await this.#model.typedefs(`${packageAndName(this.type)}${name}`));
    try {
      this.#form = new MessageForm(await part("Goal"));
      replace(this.#fields, this.#form.element);
      this.#button.disabled = false;
      this.#types.feedback = await part("Feedback");
      this.#types.result = await part("Result");
    } catch (error) {
      this.#showError((error as Error).message);
    }
  }

  #send(): void {
    const values = this.#form?.read();
    if (values === undefined || this.#button.disabled) return;
    this.#sender ??= this.#overTopics
      ? new TopicSender(this.#hub, this.name, this.type)
      : new OperationSender(this.#hub, this.name, this.type);
    this.#count += 1;
    const box = new GoalBox(this.#count, this.#sender.send(values), this.#types);
    this.#goals.unshift(box);
    this.#list.prepend(box.element);
    const old = this.#goals.filter(({ goal }, at) => at >= MAX_GOALS && goal.isFinal);
    this.#goals = this.#goals.filter((each) => !old.includes(each));
    for (const { element } of old) element.remove();
  }

  #showError(why: string): void {
    setText(this.#error, why);
    this.#error.hidden = false;
  }
}

/** One goal: its status, its newest feedback and its result. */
class GoalBox {
  readonly element: HTMLElement;
  readonly goal: Goal;
  readonly #types: ServerTypes;
  readonly #status = h("span", { class: "visually-hidden", role: "status" });
  readonly #steps = h("ol", { class: "goal-steps", "aria-hidden": "true" });
  /** The statuses that the goal has had. */
  readonly #path: Status[] = [];
  readonly #elapsed = h("span", { class: "soft small" });
  readonly #cancel = h("button", { type: "button" }, "Cancel");
  readonly #text = h("p", { class: "goal-text", hidden: true });
  readonly #feedback = h("div", { class: "goal-feedback", hidden: true });
  readonly #feedbackCount = h("h4", {});
  readonly #result = h("div", { class: "goal-result", hidden: true });
  readonly #start = performance.now();
  #tree: MessageTree | undefined;
  #frame: number | undefined;
  #hasEnded = false;

  constructor(number: number, goal: Goal, types: ServerTypes) {
    this.goal = goal;
    this.#types = types;
    this.#cancel.addEventListener("click", () => goal.cancel());
    const values = JSON.stringify(goal.values);
    this.element = h(
      "li",
      { class: "goal", "aria-label": `Goal ${number}` },
      h(
        "div",
        { class: "toolbar" },
        h("strong", {}, `Goal ${number}`),
        this.#status,
        this.#steps,
        h("time", { class: "soft small" }, timeOfDay(Date.now() / 1000)),
        this.#elapsed,
        this.#cancel,
      ),
      h("code", { class: "goal-values", title: values }, values),
      this.#text,
      this.#feedback,
      this.#result,
    );
    goal.progress.watch(() => {
      // Feedback may come more often than the screen is drawn.
      if (goal.isFinal) this.#draw();
      else this.#frame ??= requestAnimationFrame(() => this.#draw());
    });
    this.#draw();
  }

  /** Show the statuses so far, and those that usually follow. */
  #showSteps(status: Status): void {
    if (this.#path.at(-1) === status) return;
    this.#path.push(status);
    const last = this.#path.length - 1;
    replace(
      this.#steps,
      ...this.#path.map((each, at) =>
        h("li", { class: at === last ? "goal-status" : "goal-past" }, each),
      ),
      ...(AHEAD[status] ?? []).map((each) => h("li", { class: "goal-ahead" }, each)),
    );
  }

  #draw(): void {
    this.#frame = undefined;
    const { status, text, feedback, feedbackCount, result } = this.goal.progress.value;
    this.element.dataset.status = status;
    setText(this.#status, status);
    this.#showSteps(status);
    setText(this.#text, text);
    this.#text.hidden = text === "";
    this.#cancel.hidden = isFinal(status);
    if (isFinal(status) && !this.#hasEnded) {
      this.#hasEnded = true;
      const secs = (performance.now() - this.#start) / 1000;
      setText(this.#elapsed, `after ${secs.toFixed(secs < 10 ? 2 : 0)} s`);
    }
    if (feedback !== undefined) {
      if (this.#tree === undefined) {
        this.#tree = treeOf(this.#types.feedback, this.#types.plot);
        replace(this.#feedback, this.#feedbackCount, this.#tree.element);
        this.#feedback.hidden = false;
      }
      setText(this.#feedbackCount, `Feedback (${plural(feedbackCount, "message")})`);
      this.#tree.show(feedback);
    }
    if (result !== undefined && this.#result.hidden) {
      const tree = treeOf(this.#types.result);
      tree.show(result);
      replace(this.#result, h("h4", {}, "Result"), tree.element);
      this.#result.hidden = false;
    }
  }
}

function treeOf(types: Types | undefined, plot?: PlotPath): MessageTree {
  return new MessageTree(types, types?.root ?? "", plot);
}

/** An action's type as its messages spell it: ROS 2's `a/action/B` is `a/B`. */
function packageAndName(type: string): string {
  const parts = type.split("/");
  return `${parts[0]}/${parts.at(-1)}`;
}
