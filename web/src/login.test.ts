import { afterEach, beforeEach, expect, test, vi } from "vitest";

import type { Hub } from "./hub";
import { Login, siteOf, type Who } from "./login";

const TELEOP: Who = { required: true, name: "teleop", admin: false, reason: "" };
const NOBODY: Who = { required: true, name: null, admin: false, reason: "missing token" };

/** The requests that the page has made, and what the hub answers. */
let requests: [string, RequestInit][];
let answers: Response[];

beforeEach(() => {
  requests = [];
  answers = [];
  vi.stubGlobal("fetch", (url: URL, options: RequestInit) => {
    requests.push([url.href, options]);
    const answer = answers.shift();
    return answer === undefined ? Promise.reject(new TypeError("no hub")) : Promise.resolve(answer);
  });
});
afterEach(() => void vi.unstubAllGlobals());

function fakeHub(url = "ws://robot:9090/") {
  return { url, connect: vi.fn(), deny: vi.fn(), enter: vi.fn() };
}

function loginOf(hub: ReturnType<typeof fakeHub>): Login {
  return new Login(hub as unknown as Hub, "http://robot:9090/#/graph");
}

test("only the page of a hub gets its cookie", () => {
  const page = "http://robot:9090/";
  expect(siteOf("ws://robot:9090/", page)?.href).toBe("http://robot:9090/");
  expect(siteOf("ws://robot:9090/?a=b", page)?.href).toBe("http://robot:9090/");
  expect(siteOf("wss://lab/robot/", "https://lab/robot/#/plot")?.href).toBe("https://lab/robot/");
  expect(siteOf("ws://robot:9091/", page)).toBeUndefined();
  expect(siteOf("wss://robot:9090/", page)).toBeUndefined();
});

test("the page learns who it is", async () => {
  const hub = fakeHub();
  const login = loginOf(hub);
  answers = [Response.json(TELEOP)];
  await login.identify();
  expect(login.who.value).toEqual(TELEOP);
  expect(hub.deny).not.toHaveBeenCalled();
});

test("a page that is nobody is denied at once", async () => {
  const hub = fakeHub();
  answers = [Response.json(NOBODY)];
  await loginOf(hub).identify();
  expect(hub.deny).toHaveBeenCalledWith("missing token");
});

test.each([
  [Response.json({ required: false, name: null, admin: false, reason: "" })],
  [new Response("Nothing is at /login", { status: 404 })],
  [new Response("<html>")],
  [undefined],
])("hubs that want no token are not asked for a name", async (answer) => {
  const hub = fakeHub();
  const login = loginOf(hub);
  answers = answer === undefined ? [] : [answer];
  await login.identify();
  expect(login.who.value).toBeNull();
  expect(hub.deny).not.toHaveBeenCalled();
});

test("a token is sent in a header, and the page connects with its cookie", async () => {
  const hub = fakeHub();
  const login = loginOf(hub);
  answers = [new Response(null, { status: 204 }), Response.json(TELEOP)];
  expect(await login.logIn("secret")).toBe("");
  const [url, options] = requests[0] as [string, RequestInit];
  expect(url).toBe("http://robot:9090/login");
  expect(options.headers).toEqual({ Authorization: "Bearer secret" });
  expect(hub.connect).toHaveBeenCalledOnce();
  expect(login.who.value).toEqual(TELEOP);
});

test("a refused token has the hub's reason", async () => {
  const hub = fakeHub();
  const login = loginOf(hub);
  answers = [new Response("unknown token.\n", { status: 401 })];
  expect(await login.logIn("secret")).toBe("unknown token");
  expect(await login.logIn("secret")).toBe("the hub does not answer");
  expect(await login.logIn("two words")).toMatch(/no spaces/);
  expect(hub.connect).not.toHaveBeenCalled();
});

test("another hub gets the token by an operation", async () => {
  const hub = fakeHub("ws://other:9090/");
  const login = loginOf(hub);
  await login.identify();
  expect(await login.logIn("secret")).toBe("");
  expect(hub.enter).toHaveBeenCalledWith("secret");
  expect(requests).toEqual([]);
});

test("after a logout the page is disconnected", async () => {
  const hub = fakeHub();
  answers = [new Response(null, { status: 204 }), Response.json(NOBODY)];
  await loginOf(hub).logOut();
  expect(requests.map(([url]) => url)).toEqual([
    "http://robot:9090/logout",
    "http://robot:9090/login",
  ]);
  expect(hub.connect).not.toHaveBeenCalled();
  expect(hub.deny).toHaveBeenCalledWith("missing token");
});

test("after a logout the page connects as anonymous if it may", async () => {
  const hub = fakeHub();
  answers = [new Response(null, { status: 204 }), Response.json({ ...TELEOP, name: "anonymous" })];
  await loginOf(hub).logOut();
  expect(hub.connect).toHaveBeenCalledOnce();
});
