import { expect, it, test } from "vitest";
import { ABSENT, Expression, ExpressionError, problemOf, WAITING } from "./expression";

const message = {
  data: 4,
  big: 9007199254740993n,
  ok: true,
  stamp: { secs: 3, nsecs: 500_000_000 },
  twist: { linear: { x: 3, y: 4 } },
  name: ["hip", "knee, left"],
  position: [0.5, 1.5],
  ranges: Float32Array.of(1, 2, 4, 8),
  poses: [{ x: 1 }, { x: 2 }],
};

const resultOf = (text: string) => new Expression(text).evaluate(message, 0);

test.each([
  ["data", 4],
  ["big", 9007199254740993n],
  ["ok", 1],
  ["stamp", 3.5],
  ["twist.linear.x * 3.6", 3 * 3.6],
  ["1 + 2 * data", 9],
  ["(1 + 2) * data", 12],
  ["2 - 3 - data", -5],
  ["data / 2 / 2", 1],
  ["2 ^ 3 ^ 2 + 0 * data", 512],
  ["-data ^ 2", -16],
  ["2 ^ -data", 1 / 16],
  ["1.5e2 + data - .5", 153.5],
  ["sqrt(twist.linear.x^2 + twist.linear.y^2)", 5],
  ["degrees(atan2(data, data))", 45],
  ["max(data, 7) - min(data, 7)", 3],
  ["position[1]", 1.5],
  ["position[knee, left] * 2", 3],
  ["/odom.twist.linear.x*2", 6],
  ["/a/b_c.data / /a/b_c.data", 1],
])("%s is %s", (text, value) => {
  expect(resultOf(text)).toBe(value);
});

test.each([
  ["ranges[:]", [1, 2, 4, 8]],
  ["ranges[1:3] * 2", [4, 8]],
  ["ranges[2:]", [4, 8]],
  ["ranges[9:]", []],
  ["poses[:].x", [1, 2]],
  ["ranges[:] - ranges[1:]", [-1, -2, -4]],
  ["poses[:].nope", [Number.NaN, Number.NaN]],
])("%s has the elements %j", (text, values) => {
  expect(new Expression(text).isArray).toBe(true);
  expect([...(resultOf(text) as Float64Array)]).toEqual(values);
});

test.each([
  ["", "Expected a field"],
  ["3 * 2", "has no field"],
  ["data +", "Expected a field or a number, got the end"],
  ["data data", "Expected an operator, got “data”"],
  ["(data", "Expected ), got the end"],
  ["alert(data)", "Unknown function alert; there are abs,"],
  ["constructor(data)", "Unknown function constructor"],
  ["sqrt(data, 2)", "sqrt takes 1 values, got 2"],
  ["max(data)", "max takes 2 values, got 1"],
  ["/a.x - /b.x", "of one topic, not of /a and /b"],
  ["a[:].b[:]", "two ranges"],
  ["derivative(ranges[:])", "derivative of an array"],
  [`${"(".repeat(9999)}data`, "nests at most 50 levels"],
  [`${"-".repeat(9999)}data`, "nests at most 50 levels"],
])("%s is no expression", (text, why) => {
  expect(() => new Expression(text)).toThrow(ExpressionError);
  expect(problemOf(text)).toContain(why);
  expect(problemOf("data")).toBe("");
});

it("is without a number where the message has none, or no such element", () => {
  expect(resultOf("nope * 2")).toBe(undefined);
  expect(resultOf("position[9]")).toBe(undefined);
  expect(resultOf("position[ankle] + 1")).toBe(ABSENT);
  expect(resultOf("data[:]")).toBe(undefined);
});

it("has its topic apart, and keeps its text otherwise", () => {
  const expression = new Expression(" /odom.twist.linear.x  * (3.6) ");
  expect(expression.topic).toBe("/odom");
  expect(expression.text).toBe("twist.linear.x  * (3.6)");
  expect(new Expression(expression.text).topic).toBe(undefined);
});

it("follows the elements that it was for, and says their names", () => {
  const expression = new Expression("position[0] - position[1]");
  expect(expression.evaluate(message, 0)).toBe(-1);
  expect(expression.text).toBe("position[hip] - position[knee, left]");
  const other = { name: ["knee, left", "hip"], position: [7, 9] };
  expect(expression.evaluate(other, 1)).toBe(2);
});

it("has the change per second, also of integers of 64 bits", () => {
  const expression = new Expression("derivative(data) * 2");
  const at = (time: number, data: number | bigint) => expression.evaluate({ data }, time);
  expect(at(1, 10)).toBe(WAITING);
  expect(at(1.5, 11)).toBe(4);
  // Of two messages at one time, nobody can tell.
  expect(at(1.5, 99)).toBe(WAITING);
  expect(at(2.5, 10)).toBe(-2);
  expression.reset();
  expect(at(9, 0)).toBe(WAITING);
  expect(at(10, 2n ** 53n)).toBe(2 ** 54);
  expect(at(11, 2n ** 53n + 1n)).toBe(2);
});
