/** A recording as a source of messages, whose topics are those of the file. */
import { Clock } from "./clock";
import { Log } from "./console/log";
import type { GoalEnd, GoalRequest, Message, Publication, State } from "./hub";
import { DataClient } from "./messages/data_client";
import type { Origin, RecordingReport } from "./messages/recording_messages";
import type { Graph, Model, TopicInfo } from "./model";
import { NO_RATES } from "./rates";
import { typedefsOf } from "./recordings/typedefs";
import { type Signal, Source } from "./signal";
import type { DataSource } from "./source";
import type { TypeDef } from "./types";

/** The node that has published all messages, as far as the page knows. */
const NODE = "/recording";
const ABORTED = 6;
const WHY = "A recording is shown, not a hub";

export class FileSource implements DataSource {
  readonly url: string;
  readonly node = "/page";
  readonly state: Signal<State> = new Source<State>("open");
  readonly clock = new Clock();
  readonly canPublish = false;
  readonly isCongested = false;
  readonly data: DataClient;
  /** null until the file is open. */
  readonly report: Signal<RecordingReport | null>;
  readonly open: DataClient["open"];
  readonly #report = new Source<RecordingReport | null>(null);

  constructor(origin: Origin) {
    this.url = "name" in origin ? `file:${origin.name}` : origin.url;
    this.report = this.#report;
    this.data = new DataClient(this.clock, (report) => this.#report.set(report));
    this.open = (request, transfer, listener) => this.data.open(request, transfer, listener);
    this.data.send({ kind: "play file", origin });
  }

  isOwn(): boolean {
    return false;
  }

  second(): { url: string; token: string } {
    return { url: this.url, token: "" };
  }

  call<T>(service: string): Promise<T> {
    return Promise.reject(new Error(`${WHY}: ${service} cannot be called`));
  }

  advertise(_topic: string, _type: string, onError?: (why: string) => void): Publication {
    const refuse = (): void => onError?.(`${WHY}: nothing can be published`);
    const ignore = (): void => undefined;
    return { publish: refuse, setWill: ignore, clearWill: ignore, close: ignore };
  }

  sendGoal(
    _goal: GoalRequest,
    _onFeedback: (feedback: Message) => void,
    onEnd: (end: GoalEnd) => void,
  ): () => void {
    onEnd({ status: ABORTED, result: false, values: `${WHY}: no goal can be sent` });
    return () => undefined;
  }
}

/** What there is in a recording. */
export class FileModel implements Model {
  readonly graph: Signal<Graph | null>;
  readonly rates: Model["rates"] = new Source(NO_RATES);
  readonly clients: Model["clients"] = new Source([]);
  readonly log: Log;
  readonly #graph = new Source<Graph | null>(null);
  readonly #definitions = new Map<string, string>();

  constructor(source: FileSource) {
    this.graph = this.#graph;
    this.log = new Log(source);
    source.report.watch((report) => {
      if (report === null || this.#graph.value !== null) return;
      for (const { type, definition } of report.topics) this.#definitions.set(type, definition);
      this.#graph.set({
        revision: 1,
        nodes: [],
        topics: report.topics.map(topicInfo),
        services: [],
        actions: [],
      });
    });
  }

  typedefs(type: string): Promise<TypeDef[]> {
    const definition = this.#definitions.get(type);
    return definition === undefined
      ? Promise.reject(new Error(`the definition of ${type} is unknown`))
      : Promise.resolve(typedefsOf(type, definition));
  }

  requestTypedefs(type: string): Promise<TypeDef[]> {
    return this.typedefs(type);
  }

  responseTypedefs(type: string): Promise<TypeDef[]> {
    return this.typedefs(type);
  }
}

function topicInfo({ name, type }: { name: string; type: string }): TopicInfo {
  const publishers = [{ node: NODE, latch: false }];
  return { name, type, checked: true, publishers, subscriptions: [], conflicts: [] };
}
