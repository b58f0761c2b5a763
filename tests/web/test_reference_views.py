"""The main views at two widths, light and dark: where their parts are, and what these say.

Parts are compared in place of pixels, which depend on fonts. After a change that is meant,
``RECORD_VIEWS=1 python -m pytest -m browser tests/web/test_reference_views.py`` writes the file.
"""

from __future__ import annotations

import json
import os
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Twist
from fibws.msg.sensor_msgs import Image
from fibws.msg.std_msgs import Float64, String

from .conftest import OpenPage, fixture

REFERENCE = Path(__file__).parent / "answers" / "views.json"
TOLERANCE = 0.04
"""Of the window's width or height: texts have other sizes in other fonts."""
LONG = "/fleet/robot_00/perception/left_front_camera/number_1"


def pane(view: str, name: str = "") -> dict[str, object]:
    return {"view": view, "name": name}


DASHBOARD = {
    "schema": 1,
    "layout": {
        "split": "col",
        "items": [
            {"split": "row", "items": [pane("image", "/camera"), pane("raw", LONG)]},
            {"split": "row", "items": [pane("teleop", "/cmd_vel"), pane("parameters")]},
        ],
    },
}
VIEWS = {
    "graph": ("#/graph", ".drawing .topic"),
    "topics": ("#/topics", ".browse-list tbody tr"),
    "topic": ("#/topics/%2Fwave?plot=/wave:data", ".plot-canvas .u-over"),
    "services": ("#/services", ".browse-list"),
    "console": ("#/console", ".console"),
    "parameters": ("#/parameters", ".parameters-tree li"),
    "dashboard": ("#/dashboard", ".pane-image .image-facts"),
}
"""The address of each view, and what it has once it is complete."""
PARTS = """() => new Promise((resolve) => {
    const wanted = "header, h1, nav a, #tools > *, main > *, .toolbar, .pane, .pane-title, "
        + ".pane-head button, .browse-list, .browse-place, .browse-page h2, th, summary, canvas, "
        + "footer, footer > *";
    const partsNow = () => [...document.querySelectorAll(wanted)]
        .filter((element) => element.checkVisibility())
        .map((element) => {
            const {x, y, width, height} = element.getBoundingClientRect();
            const box = [x / innerWidth, y / innerHeight, width / innerWidth, height / innerHeight];
            const name = element.getAttribute("aria-label") ?? element.id ?? "";
            const text = element.children.length === 0 ? element.textContent.trim() : "";
            const kind = `${element.tagName.toLowerCase()} ${name} ${text}`.trim()
                .replace(/[0-9]+([.:][0-9]+)?/g, "0").replace(/[KM]iB/g, "B");
            return [kind, box.map((each) => Math.round(1000 * each) / 1000)];
        });
    // They move while a graph is laid out, and as panels are loaded.
    let [last, same] = ["", 0];
    const look = () => {
        const parts = partsNow();
        const text = JSON.stringify(parts);
        same = text === last ? same + 1 : 0;
        last = text;
        if (same < 40) requestAnimationFrame(look);
        else resolve(parts);
    };
    look();
})"""


@fixture
async def robot(hub: HubServer) -> AsyncIterator[None]:
    async with fibws.Node("robot", hub=hub.url) as node:
        image = await node.advertise("/camera", Image, latch=True)
        await image.publish(height=30, width=40, encoding="mono8", step=40, data=bytes(1200))
        for name, type_ in (("/wave", Float64), (LONG, Float64), ("/chatter", String)):
            await (await node.advertise(name, type_, latch=True)).publish({})
        async with node.subscribe("/cmd_vel", Twist):
            await node.params.set("/robot/speed", 0.5)
            yield


async def parts_of(page: Page, view: str) -> list[list[Any]]:
    """Return the parts of a view once they stay where they are."""
    if view == "dashboard":
        text = json.dumps(DASHBOARD).encode()
        file: Any = {"name": "a.json", "mimeType": "application/json", "buffer": text}
        await page.get_by_label("File with a layout").set_input_files(file)
    await expect(page.locator(VIEWS[view][1]).first).to_be_visible()
    await page.evaluate("document.fonts.ready")
    parts: list[list[Any]] = await page.evaluate(PARTS)
    return parts


def differences(old: list[list[Any]], new: list[list[Any]]) -> list[str]:
    """Return what has come, gone or moved."""
    names = [[kind for kind, _ in parts] for parts in (old, new)]
    if names[0] != names[1]:
        gone = [f"- {kind}" for kind in names[0] if kind not in names[1]]
        return [*gone, *(f"+ {kind}" for kind in names[1] if kind not in names[0])] or ["order"]
    return [
        f"{kind}: {before} {after}"
        for (kind, before), (_, after) in zip(old, new, strict=True)
        if any(abs(a - b) > TOLERANCE for a, b in zip(before, after, strict=True))
    ]


@pytest.mark.long
@pytest.mark.parametrize("width", [1440, 390])
@pytest.mark.parametrize("view", VIEWS)
async def test_parts_of_views_are_where_they_were(
    view: str, width: int, robot: None, hub: HubServer, open_page: OpenPage
) -> None:
    height = 900 if width > 1000 else 844
    found: dict[str, list[list[Any]]] = {}
    for scheme in ("light", "dark"):
        page = await open_page(hub, VIEWS[view][0], width=width, height=height, color_scheme=scheme)
        found[scheme] = await parts_of(page, view)
        sizes = await page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
        assert sizes[0] <= sizes[1]
    assert differences(found["light"], found["dark"]) == []
    known = json.loads(REFERENCE.read_text()) if REFERENCE.exists() else {}
    name = f"{view} {width}"
    if os.environ.get("RECORD_VIEWS"):
        known[name] = found["light"]
        lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in sorted(known.items())]
        REFERENCE.parent.mkdir(exist_ok=True)
        REFERENCE.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    assert differences(known[name], found["light"]) == []
