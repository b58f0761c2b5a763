/** What may import what: nothing in a circle, also for types alone and what is loaded later. */
import { expect, it } from "vitest";

const SOURCES: Record<string, string> = import.meta.glob("./**/*.ts", {
  query: "?raw",
  import: "default",
  eager: true,
});

/** Folders, from the lowest to the highest; each may use those before it. */
const FLOORS = [
  ["messages"],
  ["bags", "form", "parameters", "recordings"],
  ["timebar"],
  ["panels"],
  ["console", "graph", "hubs", "reconfigure", "services", "topics"],
  ["actions", "turtlesim"],
  ["dashboard"],
];

/** The modules that each module imports. The address of a worker is no import: it is a file's name. */
const IMPORTS = new Map<string, readonly string[]>(
  Object.entries(SOURCES)
    .filter(([path]) => !path.includes(".test."))
    .map(([path, text]) => [path, importsOf(path, text)]),
);

function importsOf(path: string, text: string): string[] {
  const code = text.replace(/^\s*(\/\/|\/?\*).*$/gm, "");
  const found = code.matchAll(/(?:\bfrom|\bimport)\s*\(?\s*"(\.{1,2}\/[^"?]+)"/g);
  return [...found].flatMap(([, to = ""]) => {
    const resolved = new URL(to, `file:///${path.slice(2)}`).pathname.slice(1);
    const files = [`./${resolved}`, `./${resolved}.ts`];
    // A module may name its own type.
    return files.filter((each) => each in SOURCES && each !== path);
  });
}

/** The first circle of some imports, if there is one. */
function circleIn(imports: ReadonlyMap<string, readonly string[]>): string[] {
  const done = new Set<string>();
  const path: string[] = [];
  const visit = (name: string): string[] => {
    if (path.includes(name)) return [...path.slice(path.indexOf(name)), name];
    if (done.has(name)) return [];
    path.push(name);
    for (const next of imports.get(name) ?? []) {
      const circle = visit(next);
      if (circle.length > 0) return circle;
    }
    path.pop();
    done.add(name);
    return [];
  };
  for (const name of imports.keys()) {
    const circle = visit(name);
    if (circle.length > 0) return circle;
  }
  return [];
}

function floorOf(path: string): number {
  const folder = path.split("/")[1] ?? "";
  return FLOORS.findIndex((floor) => floor.includes(folder));
}

it("no modules import each other in a circle", () => {
  expect(IMPORTS.size).toBeGreaterThan(100);
  expect(circleIn(IMPORTS)).toEqual([]);
});

it("a circle is found", () => {
  const imports = new Map([
    ["a", ["b"]],
    ["b", ["c"]],
    ["c", ["d", "b"]],
  ]);
  expect(circleIn(imports)).toEqual(["b", "c", "b"]);
  expect(importsOf("./panels/a.ts", 'void import("./panel");\nimport "../messages/feed";')).toEqual(
    ["./panels/panel.ts", "./messages/feed.ts"],
  );
});

it("every folder has a floor, and uses those below it", () => {
  const wrong: string[] = [];
  for (const [path, imports] of IMPORTS) {
    if (path.split("/").length > 2 && floorOf(path) < 0) wrong.push(`${path} has no floor`);
    for (const to of imports) {
      if (floorOf(path) >= 0 && floorOf(to) > floorOf(path)) wrong.push(`${path} uses ${to}`);
    }
  }
  expect(wrong).toEqual([]);
});

it("only the page's frame knows the hub: all others take messages from a source", () => {
  const knowHub = Object.entries(SOURCES)
    .filter(
      ([path, text]) => /\bHub\b[^"\n]* from "[./]+\/hub"/.test(text) && !path.includes(".test."),
    )
    .map(([path]) => path);
  expect(knowHub.filter((path) => path.split("/").length > 2)).toEqual([]);
  const stream = Object.keys(SOURCES).filter((path) =>
    /\bnew (Feed|DataClient|Worker)\(/.test(SOURCES[path] ?? ""),
  );
  expect(
    stream.filter((path) => path.startsWith("./panels/") && !/mesh_client|test/.test(path)),
  ).toEqual([]);
});
