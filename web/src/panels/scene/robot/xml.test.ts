import { describe, expect, it } from "vitest";
import { readXml } from "./xml";

describe("readXml", () => {
  it("reads elements, attributes and text", () => {
    const root = readXml(`<?xml version="1.0"?>
<!-- a robot -->
<!DOCTYPE robot>
<robot name='r2' xmlns:xacro="http://x">
  <link name="a &amp; b"/> text &lt;1&gt; &#x41;&#66;
  <p>1 2<!-- 3 --> 4</p><![CDATA[<raw> & ]]>
</robot>
`);
    expect(root.name).toBe("robot");
    expect(root.get("name")).toBe("r2");
    expect(root.get("xmlns:xacro")).toBe("http://x");
    expect(root.line).toBe(4);
    const [link, p] = root.children;
    expect(link?.get("name")).toBe("a & b");
    expect(link?.line).toBe(5);
    expect(p?.text).toBe("1 2 4");
    expect(root.text.trim()).toMatch(/^text <1> AB\s+<raw> &$/);
  });

  it.each([
    ["<a>\n<b>\n</a>", "line 3", "</b>"],
    ["<a>\n<b>", "line 2", "<b>"],
    ["<a/><b/>", "<b>", "<a>"],
    ["<a>\n\n<b x=1/></a>", "line 3", "quotation"],
    ["<a x='1' x='2'/>", "line 1", "x"],
    ["<a x/>", "line 1", "x"],
    ["<a x='1'y='2'/>", "line 1", "<a>"],
    ["<a>\n&nbsp;</a>", "line 2", "&nbsp;"],
    ["<a>&#x110000;</a>", "&#x110000;"],
    ["<a>&toString;</a>", "&toString;"],
    ["<a><!-- </a>", "-->"],
    ["<!DOCTYPE a [<!ENTITY b 'c'>]><a/>", "DTD"],
    ["hello", "hello"],
    ["", "no element"],
    ["<", "name"],
    ["<a", "<a>"],
    ["<a x='<'/>", "<"],
  ])("says where %j is wrong", (text, ...facts) => {
    for (const fact of facts) expect(() => readXml(text)).toThrow(fact);
  });

  it("limits the depth", () => {
    expect(() => readXml("<a>".repeat(1000) + "</a>".repeat(1000))).toThrow("deep");
  });

  it("looks for no end again and again in large documents", () => {
    let work = 0;
    const original = String.prototype.indexOf;
    String.prototype.indexOf = function (part, from = 0) {
      const found = original.call(this, part, from);
      work += (found < 0 ? this.length : found) - from;
      return found;
    };
    try {
      const text = `<a>${"<b c='1'>2</b>\n".repeat(2000)}</a>`;
      expect(readXml(text).children).toHaveLength(2000);
      expect(work).toBeLessThan(10 * text.length);
      work = 0;
      const signs = "<a>".concat("&".repeat(20_000));
      expect(() => readXml(signs)).toThrow("&");
      expect(work).toBeLessThan(10 * signs.length);
    } finally {
      String.prototype.indexOf = original;
    }
  });
});
