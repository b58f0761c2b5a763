import { afterEach, beforeEach, expect, it, vi } from "vitest";
import { KeyedRows } from "./keyed_rows";

/** An element that has children, and knows how often one was moved into it. */
class FakeParent {
  readonly children: FakeChild[] = [];
  moves = 0;

  insertBefore(child: FakeChild, next: FakeChild | null): void {
    child.remove();
    child.parent = this;
    this.moves += 1;
    this.children.splice(next === null ? Infinity : this.children.indexOf(next), 0, child);
  }

  contains(): boolean {
    return false;
  }
}

class FakeChild {
  readonly name: string;
  parent: FakeParent | undefined;

  constructor(name: string) {
    this.name = name;
  }

  remove(): void {
    const at = this.parent?.children.indexOf(this) ?? -1;
    if (at >= 0) this.parent?.children.splice(at, 1);
  }
}

function create() {
  const parent = new FakeParent();
  const rows = new KeyedRows(parent as unknown as Element, (key: string) => ({
    element: new FakeChild(key) as unknown as Element,
  }));
  const names = (): string => parent.children.map(({ name }) => name).join("");
  return { parent, rows, names };
}

beforeEach(() => {
  vi.stubGlobal("document", { activeElement: null });
});

afterEach(() => {
  vi.unstubAllGlobals();
});

it("makes, orders and removes rows, and keeps those that stay", () => {
  const { parent, rows, names } = create();
  rows.show(["a", "b", "c"]);
  const [a, b] = [rows.get("a"), rows.get("b")];
  expect(names()).toBe("abc");
  rows.show(["d", "b", "a"]);
  expect(names()).toBe("dba");
  expect([rows.get("a"), rows.get("b"), rows.get("c")]).toEqual([a, b, undefined]);
  const { moves } = parent;
  rows.show(["d", "b", "a"]);
  expect(parent.moves).toBe(moves);
  rows.show([]);
  expect([names(), [...rows.entries()].length]).toEqual(["", 0]);
});

it("has one row for each key, and a new one for a key that comes back", () => {
  const { rows, names } = create();
  rows.show(["a", "a"]);
  const first = rows.get("a");
  expect(names()).toBe("a");
  rows.show([]);
  rows.show(["a"]);
  expect(rows.get("a")).not.toBe(first);
});

it("knows items by their keys", () => {
  const parent = new FakeParent();
  const rows = new KeyedRows(
    parent as unknown as Element,
    ({ id }: { id: number; text: string }) => ({
      element: new FakeChild(String(id)) as unknown as Element,
    }),
    ({ id }) => id,
  );
  rows.show([{ id: 7, text: "a" }]);
  const row = rows.get(7);
  rows.show([{ id: 7, text: "b" }]);
  expect([rows.get(7), parent.moves]).toEqual([row, 1]);
});
