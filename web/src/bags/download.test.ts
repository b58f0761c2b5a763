import { describe, expect, it } from "vitest";
import { downloadUrl } from "./download";

describe("downloadUrl", () => {
  it("is at the page's own hub, also below a path", () => {
    expect(downloadUrl("/var/bags/a b.bag", "ws://robot:9090/", "http://robot:9090/#/topics")).toBe(
      "http://robot:9090/recordings/a%20b.bag",
    );
    expect(downloadUrl("/bags/a.mcap", "wss://lab/robot/", "https://lab/robot/")).toBe(
      "https://lab/robot/recordings/a.mcap",
    );
  });

  it("is at another hub, without what is in the query of its address", () => {
    expect(downloadUrl("C:\\bags\\a.bag", "ws://other:9090/x?token=t", "http://robot:9090/")).toBe(
      "http://other:9090/x/recordings/a.bag",
    );
  });
});
