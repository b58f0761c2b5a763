/** Shows small readings: joints as bars, the attitude of an IMU, a battery, and a position with its track. */
import { greatest, least } from "../../lists";
import "./readings.css";

import { h, replace, setAttribute, setText, svg } from "../../dom";
import { ago } from "../../format";
import type { Message } from "../../hub";
import { subscribe } from "../../messages/data_client";
import { elements, fixedText } from "../../messages/values";
import type { Model } from "../../model";
import type { DataSource } from "../../source";
import { own } from "../../types";
import type { Panel } from "../panel";
import { Joints } from "./joints";
import type { Reading } from "./reading";
import { READING_TYPES } from "./types";

/** Minimum time between two messages, in ms. */
const THROTTLE = 100;
/** Time between two updates of the age, in ms. */
const TICK = 1000;
/** A reading is old after this time, in ms. */
const STALE = 5000;

const READINGS: Readonly<Record<string, (hub: DataSource, topic: string) => Reading>> = {
  [READING_TYPES.joints]: (hub, topic) => new Joints(hub, topic),
  [READING_TYPES.attitude]: () => new Attitude(),
  [READING_TYPES.battery]: () => new Battery(),
  [READING_TYPES.position]: () => new Position(),
};

export function makePanel(hub: DataSource, model: Model, topic: string, type: string): Panel {
  const make = READINGS[type];
  if (make === undefined) throw new Error(`no reading shows ${type}`);
  return new ReadingPanel(hub, model, topic, make(hub, topic));
}

class ReadingPanel implements Panel {
  readonly element: HTMLElement;
  readonly #hub: DataSource;
  readonly #model: Model;
  readonly #topic: string;
  readonly #reading: Reading;
  readonly #age = h("p", { class: "soft small" });
  readonly #error = h("p", { class: "error", role: "alert", hidden: true });
  #arrived: number | undefined;
  #stop: (() => void) | undefined;
  #timer: number | undefined;

  constructor(hub: DataSource, model: Model, topic: string, reading: Reading) {
    this.#hub = hub;
    this.#model = model;
    this.#topic = topic;
    this.#reading = reading;
    reading.element.hidden = true;
    this.element = h("div", { class: "reading" }, this.#error, reading.element, this.#age);
  }

  show(): void {
    if (this.#stop !== undefined) return;
    const unwatch = this.#hub.clock.onJump(() => {
      this.#arrived = undefined;
      this.#reading.element.hidden = true;
      this.#showAge();
    });
    const unsubscribe = subscribe(
      this.#hub,
      { topic: this.#topic, throttle: THROTTLE },
      (message, { time }) => {
        this.#arrived = time;
        this.#error.hidden = true;
        this.#reading.element.hidden = false;
        this.#reading.show(message);
        this.#showAge();
      },
      (why) => {
        setText(this.#error, why);
        this.#error.hidden = why === "";
      },
    );
    this.#stop = () => {
      unwatch();
      unsubscribe();
    };
    this.#timer = window.setInterval(() => this.#showAge(), TICK);
    this.#showAge();
  }

  hide(): void {
    this.#stop?.();
    this.#stop = undefined;
    window.clearInterval(this.#timer);
  }

  #showAge(): void {
    if (this.#arrived === undefined) {
      const topic = this.#model.graph.value?.topics.find(({ name }) => name === this.#topic);
      const isPublished = topic !== undefined && topic.publishers.length > 0;
      setText(
        this.#age,
        isPublished ? "No message yet." : `No message: no node publishes ${this.#topic}.`,
      );
      return;
    }
    const age = Math.max(0, this.#hub.clock.now() - this.#arrived);
    this.#reading.element.classList.toggle("stale", age > STALE);
    setText(this.#age, age > STALE ? `no message since ${ago(age / 1000)}` : "");
  }
}

/** The number at a path of a message; NaN for those that JSON has no number for. */
function numberOf(message: unknown, ...path: string[]): number {
  const value = path.reduce(own, message);
  return typeof value === "number" ? value : Number.NaN;
}

/** A list of names and values; those without a value are left out. */
function facts(rows: readonly (readonly [name: string, value: string])[]): Node[] {
  return rows
    .filter(([, value]) => value !== "")
    .flatMap(([name, value]) => [h("dt", {}, name), h("dd", { class: "mono" }, value)]);
}

/** A number with its unit, or nothing. */
function text(value: number, unit: string, digits = 2): string {
  const space = unit === "" || unit === "°" ? "" : " ";
  return Number.isNaN(value) ? "" : fixedText(value, digits) + space + unit;
}

/** The artificial horizon of an IMU. */
class Attitude implements Reading {
  readonly #ground = svg("g", {}, ...horizon());
  readonly #picture = svg(
    "svg",
    { viewBox: "-50 -50 100 100", role: "img", class: "horizon" },
    this.#ground,
    svg("path", { d: "M-24 0h14l4 5 M24 0h-14l-4 5 M0 0v.1", class: "horizon-mark" }),
    svg("circle", { r: 49, class: "horizon-rim" }),
  );
  readonly #facts = h("dl", { class: "reading-facts" });
  readonly element = h("div", { class: "reading-pair" }, this.#picture, this.#facts);

  show(message: Message): void {
    const [x, y, z, w] = ["x", "y", "z", "w"].map((part) =>
      numberOf(message, "orientation", part),
    ) as [number, number, number, number];
    const turn = (part: string): number => numberOf(message, "angular_velocity", part);
    const pull = (part: string): number => numberOf(message, "linear_acceleration", part);
    // REP 145: the first covariance is -1 if there is no orientation.
    const hasOrientation =
      numberOf(message, "orientation_covariance", "0") !== -1 &&
      x * x + y * y + z * z + w * w > 0.5;
    // Where up is, in the frame of the IMU; at rest, the acceleration points there, too.
    const [ux, uy, uz] = hasOrientation
      ? [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
      : [pull("x"), pull("y"), pull("z")];
    const roll = (Math.atan2(uy, uz) * 180) / Math.PI;
    const pitch = (Math.atan2(-ux, Math.hypot(uy, uz)) * 180) / Math.PI;
    const yaw = (Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)) * 180) / Math.PI;
    // Half a degree cannot be seen. Nose down is a positive pitch: the horizon rises.
    if (Number.isFinite(roll) && Number.isFinite(pitch)) {
      const offset = (-pitch).toFixed(1);
      setAttribute(
        this.#ground,
        "transform",
        `rotate(${(-roll).toFixed(1)}) translate(0 ${offset})`,
      );
    }
    const label = `Roll ${roll.toFixed(0)}°, pitch ${pitch.toFixed(0)}°`;
    setAttribute(this.#picture, "aria-label", label);
    const vector = (part: (axis: string) => number, unit: string): string =>
      text(part("x"), "") &&
      `${["x", "y", "z"].map((axis) => part(axis).toFixed(2)).join(", ")} ${unit}`;
    replace(
      this.#facts,
      ...facts([
        ["roll", text(roll, "°", 1)],
        ["pitch", text(pitch, "°", 1)],
        ["yaw", hasOrientation ? text(yaw, "°", 1) : ""],
        ["from", hasOrientation ? "orientation" : "acceleration"],
        ["turning", vector(turn, "rad/s")],
        ["acceleration", vector(pull, "m/s²")],
      ]),
    );
  }
}

/** Sky, ground and marks at each ten degrees, of which one is a unit. */
function horizon(): SVGElement[] {
  const marks = [-30, -20, -10, 10, 20, 30].map((pitch) =>
    svg("line", { x1: -pitch / 3, x2: pitch / 3, y1: -pitch, y2: -pitch, class: "horizon-line" }),
  );
  return [
    svg("rect", { x: -200, y: -400, width: 400, height: 400, class: "horizon-sky" }),
    svg("rect", { x: -200, y: 0, width: 400, height: 400, class: "horizon-ground" }),
    svg("line", { x1: -200, x2: 200, y1: 0, y2: 0, class: "horizon-line" }),
    ...marks,
  ];
}

/** The words for the constants of sensor_msgs/BatteryState. */
const BATTERY_STATUS = ["", "charging", "discharging", "not charging", "full"];
const BATTERY_HEALTH = [
  "",
  "good",
  "overheated",
  "dead",
  "overvoltage",
  "failed",
  "cold",
  "watchdog timer expired",
  "safety timer expired",
];
/** Below these parts of its charge, a battery is low, and nearly empty. */
const LOW = 0.3;
const EMPTY = 0.15;

class Battery implements Reading {
  readonly #level = h("div", { class: "battery-level" });
  readonly #percent = h("p", { class: "battery-percent" });
  readonly #facts = h("dl", { class: "reading-facts" });
  readonly element = h(
    "div",
    { class: "reading-pair" },
    h("div", {}, h("div", { class: "battery", "aria-hidden": "true" }, this.#level), this.#percent),
    this.#facts,
  );

  show(message: Message): void {
    const given = numberOf(message, "percentage");
    // It is a part of 1, but many drivers publish percents.
    const part = given > 1 ? given / 100 : given;
    const isKnown = part >= 0;
    const state = !isKnown || part >= LOW ? "" : part >= EMPTY ? "low" : "empty";
    this.#level.style.setProperty(
      "--level",
      isKnown ? `${(100 * Math.min(1, part)).toFixed(0)}%` : "0",
    );
    setAttribute(this.#level, "data-state", state);
    const warning = state === "" ? "" : ` ⚠ ${state === "low" ? "low" : "nearly empty"}`;
    setText(this.#percent, isKnown ? `${(100 * part).toFixed(0)} %${warning}` : "charge unknown");
    const volts = own(message, "cell_voltage");
    const cells = Array.from(elements(volts) ?? []).filter((volt) => typeof volt === "number");
    const weakest = cells.length === 0 ? Number.NaN : least(cells);
    replace(
      this.#facts,
      ...facts([
        ["state", BATTERY_STATUS[numberOf(message, "power_supply_status")] ?? ""],
        ["health", BATTERY_HEALTH[numberOf(message, "power_supply_health")] ?? ""],
        ["voltage", text(numberOf(message, "voltage"), "V")],
        ["current", text(numberOf(message, "current"), "A")],
        ["charge", text(numberOf(message, "charge"), "Ah")],
        ["capacity", text(numberOf(message, "capacity"), "Ah")],
        ["temperature", text(numberOf(message, "temperature"), "°C", 1)],
        ["weakest cell", text(weakest, "V")],
        ["place", String(own(message, "location") ?? "")],
      ]),
    );
  }
}

/** The words for the status of sensor_msgs/NavSatStatus, from -1 on. */
const FIX = ["no fix", "fix", "fix with satellite augmentation", "fix with ground augmentation"];
/** How many places of the track are kept, and the least distance between two of them, in m. */
const MAX_TRACK = 500;
const MIN_STEP = 0.2;
/** Meters of a degree of latitude. */
const DEGREE = 111_320;
/** Lengths of the bar that shows the scale of the track, in m. */
const SCALES = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000];

/** A position on the earth, and the track since the first one: there is no map, which hubs without internet lack. */
class Position implements Reading {
  readonly #line = svg("polyline", { class: "track-line" });
  readonly #here = svg("circle", { r: 1.6, class: "track-here" });
  readonly #scaleBar = svg("path", { class: "track-scale" });
  readonly #scaleText = svg("text", { x: 4, y: 93, class: "track-text" });
  readonly #picture = svg(
    "svg",
    { viewBox: "0 0 100 100", role: "img", class: "track" },
    svg("text", { x: 50, y: 6, class: "track-text track-north" }, "N"),
    this.#line,
    this.#here,
    this.#scaleBar,
    this.#scaleText,
  );
  readonly #facts = h("dl", { class: "reading-facts" });
  readonly element = h("div", { class: "reading-pair" }, this.#picture, this.#facts);
  #origin: readonly [latitude: number, longitude: number] | undefined;
  /** Places in meters to the east and to the north of the first one. */
  #track: (readonly [east: number, north: number])[] = [];

  show(message: Message): void {
    const latitude = numberOf(message, "latitude");
    const longitude = numberOf(message, "longitude");
    const status = numberOf(message, "status", "status");
    const hasFix = status >= 0 && Number.isFinite(latitude) && Number.isFinite(longitude);
    if (hasFix) this.#add(latitude, longitude);
    const variance = numberOf(message, "position_covariance", "0");
    const north = numberOf(message, "position_covariance", "4");
    const isKnown = numberOf(message, "position_covariance_type") > 0;
    replace(
      this.#facts,
      ...facts([
        ["status", FIX[status + 1] ?? ""],
        ["latitude", text(latitude, "°", 7)],
        ["longitude", text(longitude, "°", 7)],
        ["altitude", text(numberOf(message, "altitude"), "m")],
        ["accuracy", isKnown ? text(Math.sqrt(Math.max(variance, north)), "m") : ""],
        ["from the start", this.#track.length > 1 ? text(Math.hypot(...this.#place), "m", 1) : ""],
      ]),
    );
  }

  get #place(): readonly [number, number] {
    return this.#track.at(-1) ?? [0, 0];
  }

  #add(latitude: number, longitude: number): void {
    this.#origin ??= [latitude, longitude];
    const [first, start] = this.#origin;
    const east = (longitude - start) * DEGREE * Math.cos((first * Math.PI) / 180);
    const north = (latitude - first) * DEGREE;
    const [lastEast, lastNorth] = this.#place;
    const isFirst = this.#track.length === 0;
    if (!isFirst && Math.hypot(east - lastEast, north - lastNorth) < MIN_STEP) return;
    this.#track.push([east, north]);
    if (this.#track.length > MAX_TRACK) this.#track.shift();
    this.#draw();
  }

  #draw(): void {
    const all = (at: 0 | 1): number[] => this.#track.map((place) => place[at]);
    const [west, east] = [least(all(0)), greatest(all(0))];
    const [south, north] = [least(all(1)), greatest(all(1))];
    const span = Math.max(east - west, north - south, 5);
    const scale = 80 / span;
    const x = (place: number): string => (50 + (place - (west + east) / 2) * scale).toFixed(1);
    const y = (place: number): string => (50 - (place - (south + north) / 2) * scale).toFixed(1);
    setAttribute(this.#line, "points", this.#track.map(([e, n]) => `${x(e)},${y(n)}`).join(" "));
    const [e, n] = this.#place;
    setAttribute(this.#here, "cx", x(e));
    setAttribute(this.#here, "cy", y(n));
    const length = SCALES.findLast((each) => each * scale <= 40) ?? 1;
    setAttribute(this.#scaleBar, "d", `M4 96v2h${(length * scale).toFixed(1)}v-2`);
    setText(this.#scaleText, length < 1000 ? `${length} m` : `${length / 1000} km`);
    setAttribute(
      this.#picture,
      "aria-label",
      `Track of ${this.#track.length} places, ${span.toFixed(0)} m wide; now ${e.toFixed(0)} m east and ${n.toFixed(0)} m north of its start`,
    );
  }
}
