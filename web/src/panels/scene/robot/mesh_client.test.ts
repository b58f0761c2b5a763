import { describe, expect, it, vi } from "vitest";

vi.mock("../../../script_urls", () => ({ meshWorker: "mesh.worker.js" }));

import { addressOf } from "./mesh_client";

const PAGE = "http://robot:9090/#/topics";

describe("addressOf", () => {
  it("asks the page's own hub, with the token that the page has", () => {
    const { url, init } = addressOf("package://my_arm/m/a b%20c.stl", "ws://robot:9090/", "", PAGE);
    expect(url).toBe("http://robot:9090/assets/package/my_arm/m/a%20b%20c.stl");
    expect(init.headers).toEqual({});
    const own = addressOf("package://a/b.stl", "ws://robot:9090/", "t", PAGE);
    expect(own.init.headers).toEqual({ Authorization: "Bearer t" });
  });

  it("finds hubs below a path", () => {
    const page = "https://lab/robot/";
    expect(addressOf("package://a/b.stl", "wss://lab/robot/", "", page).url).toBe(
      "https://lab/robot/assets/package/a/b.stl",
    );
  });

  it("asks other hubs with the token, which is in no address", () => {
    const { url, init } = addressOf("package://a/b.stl", "ws://other:9090/x?key=5", "t&u", PAGE);
    expect(url).toBe("http://other:9090/x/assets/package/a/b.stl");
    expect(init).toEqual({ headers: { Authorization: "Bearer t&u" }, credentials: "omit" });
  });

  it("leaves no way to other files of the hub", () => {
    const { url } = addressOf("package://../../x?y#z.stl", "ws://robot:9090/", "", PAGE);
    expect(url.startsWith("http://robot:9090/")).toBe(true);
    expect(new URL(url).search).toBe("");
  });

  it("refuses files of other kinds of addresses", () => {
    expect(addressOf("https://x/a.stl", "ws://robot/", "", PAGE).init.credentials).toBe("omit");
    for (const uri of ["file:///a.stl", "a.stl", ""]) {
      expect(() => addressOf(uri, "ws://robot/", "", PAGE)).toThrow("package://");
    }
  });
});
