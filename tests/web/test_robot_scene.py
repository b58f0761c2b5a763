"""Robots and markers in the scene: where their colours are on the picture."""

from __future__ import annotations

import asyncio
import math
import struct
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest
from playwright.async_api import Page, expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Point, Pose, Quaternion, TransformStamped, Vector3
from fibws.msg.sensor_msgs import JointState
from fibws.msg.std_msgs import ColorRGBA, Header, String
from fibws.msg.tf2_msgs import TFMessage
from fibws.msg.visualization_msgs import (
    InteractiveMarker,
    InteractiveMarkerControl,
    InteractiveMarkerInit,
    InteractiveMarkerPose,
    InteractiveMarkerUpdate,
    Marker,
    MarkerArray,
)

from .conftest import TIMEOUT, Complaints, OpenPage, fixture

RED, GREEN, BLUE = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
YELLOW, PINK, CYAN = (1.0, 1.0, 0.0), (1.0, 0.2, 0.7), (0.0, 1.0, 1.0)
HUES = {RED: 0, YELLOW: 2, GREEN: 4, CYAN: 6, BLUE: 8, PINK: 11}
"""The hues of colours in twelfths of the circle: light changes only how bright they are."""
PIXELS = """(canvas) => {
    const { width, height } = canvas;
    const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, width, height);
    const found = Array.from({ length: 12 }, () => [0, 0, 0]);
    for (let at = 0; at < data.length; at += 4) {
        const [r, g, b] = data.subarray(at, at + 3);
        const most = Math.max(r, g, b), span = most - Math.min(r, g, b);
        if (span < 60 || span < 0.4 * most) continue;
        let hue = 4 + (r - g) / span;
        if (most === r) hue = (g - b) / span;
        else if (most === g) hue = 2 + (b - r) / span;
        const sum = found[Math.round(2 * hue + 12) % 12];
        sum[0] += 1;
        sum[1] += (at / 4) % width;
        sum[2] += Math.floor(at / 4 / width);
    }
    return [found.map(([count, x, y]) => [count, x / count, y / count]), width, height];
}"""
DISTANCE = 10.0
"""How far away the camera is at first."""
ENOUGH = 15
"""Pixels of a colour that are more than an edge."""


@pytest.fixture(autouse=True)
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with a mesh: a yellow robot's box of 1 m, whose triangles have no colour."""
    package = tmp_path / "ws/arm"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>arm</name></package>")
    (package / "box.stl").write_bytes(stl_box())
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ws"))
    return package


def stl_box() -> bytes:
    """Return a box of 1 m about the origin as binary STL."""
    facets = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            corners = []
            for a, b in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3] = side, a, b
                corners.append(corner)
            if side < 0:
                corners.reverse()
            for three in ((0, 1, 2), (0, 2, 3)):
                numbers = [number for at in three for number in corners[at]]
                facets.append(struct.pack("<12fH", 0, 0, 0, *numbers, 0))
    return bytes(80) + struct.pack("<I", len(facets)) + b"".join(facets)


@fixture
async def robot(hub: HubServer) -> AsyncIterator[fibws.Node]:
    async with fibws.Node("robot", hub=hub.url) as node:
        yield node


class Scene:
    """The scene on a topic's page, seen from above: the origin is in its middle."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self._canvas = page.locator(".scene-canvas")

    async def places(self) -> dict[Any, tuple[float, float]]:
        """Return where the middles of colours are, in m."""
        found, width, height = await self._canvas.evaluate(PIXELS)
        meter = height / 2 / (DISTANCE * math.tan(math.pi / 8))
        return {
            color: ((found[hue][1] - width / 2) / meter, (height / 2 - found[hue][2]) / meter)
            for color, hue in HUES.items()
            if found[hue][0] >= ENOUGH
        }

    async def shows(self, wanted: dict[Any, tuple[float, float]]) -> None:
        """Wait until exactly these colours are at these places."""
        found: dict[Any, tuple[float, float]] = {}
        try:
            async with asyncio.timeout(TIMEOUT / 1000):
                while not _are_near(found := await self.places(), wanted):
                    await self.page.evaluate("new Promise(requestAnimationFrame)")
        except TimeoutError:
            pytest.fail(f"expected {wanted}, got {found}")

    def row(self, topic: str) -> Any:
        """The row of a layer."""
        return self.page.locator(".scene-layer-list > li").filter(
            has=self.page.get_by_text(topic, exact=True)
        )


def _are_near(found: dict[Any, tuple[float, float]], wanted: dict[Any, Any]) -> bool:
    return found.keys() == wanted.keys() and all(
        math.dist(place, wanted[color]) < 0.08 for color, place in found.items()
    )


async def scene_of(open_page: OpenPage, hub: HubServer, topic: str, **options: Any) -> Scene:
    route = f"#/topics/{topic.replace('/', '%2F')}"
    page = await open_page(hub, route, width=1440, **options)
    # The key keeps the distance, "2D" would show all there is.
    await page.get_by_role("group", name="Scene").focus()
    await page.keyboard.press("1")
    return Scene(page)


def marker(
    number: int, type_: int, place: tuple[float, float], color: tuple[float, float, float]
) -> Marker:
    found = Marker(Header(frame_id="map"), "", number, type_)
    found.pose = Pose(Point(*place, 0.0), Quaternion(w=1.0))
    found.scale, found.color = Vector3(0.3, 0.3, 0.3), ColorRGBA(*color, 1.0)
    return found


def cube(number: int, place: tuple[float, float], color: tuple[float, float, float]) -> Marker:
    return marker(number, Marker.CUBE, place, color)


async def test_markers_are_where_they_should_be(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    markers = await robot.advertise("/markers", MarkerArray, latch=True)
    places = {RED: (0.0, 0.0), GREEN: (1.0, 0.0), BLUE: (0.0, 1.0)}
    three = [cube(at, place, color) for at, (color, place) in enumerate(places.items())]
    await markers.publish(MarkerArray(three))
    scene = await scene_of(open_page, hub, "/markers")
    # From above, x is to the right and y upwards.
    await scene.shows(places)
    await expect(scene.row("/markers")).to_contain_text("3 markers")


async def test_markers_end_when_they_are_deleted_or_their_time_is_over(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    topic = await robot.advertise("/marker", Marker, peers=True)
    scene = await scene_of(open_page, hub, "/marker", has_clock=True)
    async for names in topic.peers.changes():
        if names:
            break
    await topic.publish(cube(0, (0.0, 0.0), RED))
    await topic.publish(cube(1, (1.0, 0.0), GREEN))
    await scene.shows({RED: (0, 0), GREEN: (1, 0)})
    await topic.publish(cube(1, (1.0, -1.0), GREEN))
    await scene.shows({RED: (0, 0), GREEN: (1, -1)})
    short = cube(2, (0.0, 1.0), BLUE)
    short.lifetime = fibws.Duration(600)
    await topic.publish(short)
    # It comes and goes: what was published before stays.
    await scene.shows({RED: (0, 0), GREEN: (1, -1), BLUE: (0, 1)})
    await scene.page.clock.fast_forward("10:00")
    await scene.shows({RED: (0, 0), GREEN: (1, -1)})
    await topic.publish(Marker(ns="", id=1, action=Marker.DELETE))
    await scene.shows({RED: (0, 0)})
    await topic.publish(Marker(ns="any", action=Marker.DELETEALL))
    await scene.shows({})


async def test_namespaces_can_be_hidden(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    topic = await robot.advertise("/markers", MarkerArray, latch=True)
    two = [cube(0, (0.0, 0.0), RED), cube(1, (1.0, 0.0), GREEN)]
    two[1].ns = "walls"
    await topic.publish(MarkerArray(two))
    scene = await scene_of(open_page, hub, "/markers")
    await scene.shows({RED: (0, 0), GREEN: (1, 0)})
    await scene.page.get_by_role("button", name="Settings of /markers").click()
    await scene.page.get_by_label("walls").uncheck()
    await scene.shows({RED: (0, 0)})
    await scene.page.get_by_label("(none)").uncheck()
    await scene.page.get_by_label("walls").check()
    await scene.shows({GREEN: (1, 0)})


def points(*places: tuple[float, float]) -> list[Point]:
    return [Point(x, y, 0.0) for x, y in places]


def listed(kind: str) -> Marker:
    """Return a green marker of a kind whose middle is at x = 1, y = 1."""
    found = marker(9, getattr(Marker, kind), (1.0, 1.0), GREEN)
    match kind:
        case "ARROW":
            found.pose.position.x = 0.85
        case "LINE_STRIP":
            found.scale.x = 0.1
            found.points = points((-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2))
        case "LINE_LIST":
            found.points = points((-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2))
            found.scale.x, found.colors = 0.1, [ColorRGBA(*GREEN, 1.0)] * 4
            found.color = ColorRGBA(*RED, 1.0)
        case "CUBE_LIST" | "SPHERE_LIST" | "POINTS":
            found.points = points((-0.3, 0.0), (0.3, 0.0))
            found.colors = [ColorRGBA(*GREEN, 1.0)] * 2
            found.color = ColorRGBA(*RED, 1.0)
        case "TRIANGLE_LIST":
            found.scale = Vector3(1.0, 1.0, 1.0)
            found.points = points((-0.3, -0.3), (0.3, -0.3), (0.3, 0.3))
            found.points += points((-0.3, -0.3), (0.3, 0.3), (-0.3, 0.3))
            found.colors = [ColorRGBA(*GREEN, 1.0)] * 2
        case "MESH_RESOURCE":
            found.mesh_resource = "package://arm/box.stl"
    return found


KINDS = ["ARROW", "CUBE", "SPHERE", "CYLINDER", "LINE_STRIP", "LINE_LIST", "CUBE_LIST"]
KINDS += ["SPHERE_LIST", "POINTS", "MESH_RESOURCE", "TRIANGLE_LIST"]


async def test_every_kind_of_marker_is_drawn_at_its_place(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    await fibws_parameter(robot, '<robot name="r"><!-- package://arm/ --><link name="a"/></robot>')
    topic = await robot.advertise("/markers", MarkerArray, latch=True)
    await topic.publish(MarkerArray([cube(0, (0.0, 0.0), RED)]))
    scene = await scene_of(open_page, hub, "/markers")
    await scene.shows({RED: (0, 0)})
    for kind in KINDS:
        await topic.publish(MarkerArray([listed(kind)]))
        await scene.shows({RED: (0, 0), GREEN: (1, 1)})
        await topic.publish(MarkerArray([Marker(id=9, action=Marker.DELETE)]))
        await scene.shows({RED: (0, 0)})
    text = listed("TEXT_VIEW_FACING")
    text.text = "<b>Kitchen</b>"
    arrow = listed("ARROW")
    arrow.id, arrow.pose.position.x = 10, 1.0
    arrow.points = points((-0.3, 0.0), (0.3, 0.0))
    arrow.scale = Vector3(0.1, 0.2, 0.0)
    await topic.publish(MarkerArray([text, arrow]))
    await expect(scene.page.locator(".scene-labels")).to_have_text("<b>Kitchen</b>")
    await scene.shows({RED: (0, 0), GREEN: (1, 1)})


async def test_faults_of_markers_are_said(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node, complaints: Complaints
) -> None:
    topic = await robot.advertise("/markers", MarkerArray, latch=True)
    flat = cube(7, (0.0, 0.0), RED)
    flat.scale.z = 0.0
    await topic.publish(MarkerArray([flat]))
    scene = await scene_of(open_page, hub, "/markers")
    await expect(scene.row("/markers")).to_contain_text("marker 7 has a scale of 0")
    missing = marker(8, Marker.MESH_RESOURCE, (0.0, 0.0), RED)
    missing.mesh_resource = "package://nowhere/a.stl"
    await topic.publish(MarkerArray([missing]))
    await expect(scene.row("/markers")).to_contain_text("package://nowhere/a.stl")
    await expect(scene.row("/markers")).to_contain_text("robot_description")
    complaints.allow("404")
    await topic.publish(MarkerArray([marker(9, 99, (0.0, 0.0), RED)]))
    await expect(scene.row("/markers")).to_contain_text("unknown type 99")


def frame(parent: str, child: str, place: tuple[float, float], stamp: int) -> TFMessage:
    header = Header(stamp=fibws.Time(stamp), frame_id=parent)
    found = TransformStamped(header, child)
    found.transform.translation = Vector3(*place, 0.0)
    found.transform.rotation.w = 1.0
    return TFMessage([found])


async def test_locked_markers_go_along_with_their_frame(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    tf = await robot.advertise("/tf", TFMessage, latch=True)
    await tf.publish(frame("map", "carrier", (0.0, 0.0), 100))
    topic = await robot.advertise("/markers", MarkerArray, latch=True)
    two = [cube(0, (0.0, 0.0), RED), cube(1, (0.0, 1.0), GREEN)]
    for each in two:
        each.header = Header(stamp=fibws.Time(100), frame_id="carrier")
    two[1].frame_locked = True
    await topic.publish(MarkerArray(two))
    scene = await scene_of(open_page, hub, "/markers")
    await scene.page.get_by_role("checkbox", name="/tf Frames").uncheck()
    await scene.shows({RED: (0, 0), GREEN: (0, 1)})
    await tf.publish(frame("map", "carrier", (-1.0, 0.0), 101))
    await scene.shows({RED: (0, 0), GREEN: (-1, 1)})


async def test_interactive_markers_are_drawn_and_follow_updates(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    full = await robot.advertise("/menu/update_full", InteractiveMarkerInit, latch=True)
    updates = await robot.advertise("/menu/update", InteractiveMarkerUpdate, peers=True)
    handle = marker(0, Marker.CUBE, (0.0, 0.0), GREEN)
    handle.header.frame_id = ""
    control = InteractiveMarkerControl(markers=[handle], always_visible=True)
    fixed = InteractiveMarker(Header(frame_id="map"), name="fixed", controls=[control])
    fixed.pose.orientation.w = 1.0
    red = InteractiveMarkerControl(markers=[cube(0, (0.0, 0.0), RED)])
    other = InteractiveMarker(Header(frame_id="map"), name="origin", controls=[red])
    other.pose.orientation.w = 1.0
    fixed.pose.position.x = 1.0
    await full.publish(InteractiveMarkerInit("/menu", 0, [fixed, other]))
    scene = await scene_of(open_page, hub, "/menu/update_full")
    await scene.shows({GREEN: (1, 0), RED: (0, 0)})
    async for names in updates.peers.changes():
        if names:
            break
    pose = InteractiveMarkerPose(Header(frame_id="map"), name="fixed")
    pose.pose = Pose(Point(-1.0, 0.0, 0.0), Quaternion(w=1.0))
    update = InteractiveMarkerUpdate("/menu", 1, InteractiveMarkerUpdate.UPDATE, poses=[pose])
    await updates.publish(update)
    await scene.shows({GREEN: (-1, 0), RED: (0, 0)})
    erase = InteractiveMarkerUpdate("/menu", 2, InteractiveMarkerUpdate.UPDATE, erases=["fixed"])
    await updates.publish(erase)
    await scene.shows({RED: (0, 0)})


ARM = """<robot name="arm">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base"><visual><geometry><box size="0.3 0.3 0.1"/></geometry>
    <material name="red"/></visual></link>
  <link name="tip"><visual><origin xyz="1 0 0"/><geometry><sphere radius="0.2"/></geometry>
    <material name="own"><color rgba="0 1 0 1"/></material></visual></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="tip"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>"""


async def fibws_parameter(node: fibws.Node, text: str) -> None:
    await node.params.set("/robot_description", text)


async def test_links_move_with_joints(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    await fibws_parameter(robot, ARM)
    joints = await robot.advertise("/joint_states", JointState, latch=True)
    scene = await scene_of(open_page, hub, "/joint_states")
    await scene.shows({RED: (0, 0), GREEN: (1, 0)})
    # Without states, a slider moves the joint.
    await scene.page.get_by_role("button", name="Settings of /robot_description").click()
    slider = scene.page.locator(".scene-joints input")
    await slider.fill("-1")
    await scene.shows({RED: (0, 0), GREEN: (math.cos(1), -math.sin(1))})
    await joints.publish(JointState(name=["shoulder"], position=[math.pi / 2]))
    await scene.shows({RED: (0, 0), GREEN: (0, 1)})
    await expect(slider).to_have_count(0)
    await expect(scene.row("/robot_description")).to_contain_text("no tf for base")
    # Another robot is launched: its description, and a node.
    await fibws_parameter(robot, ARM.replace('xyz="1 0 0"', 'xyz="2 0 0"'))
    await robot.advertise("/other", JointState)
    await scene.shows({RED: (0, 0), GREEN: (0, 2)})


async def test_links_are_where_tf_has_them(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node
) -> None:
    description = await robot.advertise("/robot_description", String, latch=True)
    await description.publish(String(ARM.replace('"base"', '"carrier"')))
    static = await robot.advertise("/tf_static", TFMessage, latch=True)
    await robot.advertise("/joint_states", JointState)
    transforms = [
        *frame("map", "carrier", (-1.0, 1.0), 1).transforms,
        *frame("map", "tip", (0.0, -1.0), 1).transforms,
    ]
    scene = await scene_of(open_page, hub, "/joint_states")
    await scene.shows({RED: (0, 0), GREEN: (1, 0)})
    await static.publish(TFMessage(transforms))
    await scene.page.get_by_role("checkbox", name="/tf Frames").uncheck()
    # The sphere is 1 m ahead of its link.
    await scene.shows({RED: (-1, 1), GREEN: (1, -1)})
    await expect(scene.row("/robot_description")).to_contain_text("arm: 2 links, 1 joint by tf")


async def test_meshes_are_loaded_and_missing_ones_are_pink_and_named(
    open_page: OpenPage, hub: HubServer, robot: fibws.Node, complaints: Complaints
) -> None:
    def mesh(link: str, file: str, x: float) -> str:
        return (
            f'<link name="{link}"><visual><origin xyz="{x} 0 0"/><geometry><mesh '
            f'filename="package://arm/{file}" scale="0.4 0.4 0.4"/></geometry>'
            '<material name="m"><color rgba="1 1 0 1"/></material></visual></link>'
        )

    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'
    description = await robot.advertise("/robot_description", String, latch=True)
    urdf = f'<robot name="r">{mesh("a", "box.stl", 0)}{mesh("b", "gone.stl", 1)}{joint}</robot>'
    await description.publish(String(urdf))
    await robot.advertise("/joint_states", JointState)
    scene = await scene_of(open_page, hub, "/joint_states")
    await scene.shows({YELLOW: (0, 0), PINK: (1, 0)})
    row = scene.row("/robot_description")
    await expect(row).to_contain_text("gone.stl")
    await expect(row).to_contain_text("on the hub's machine")
    complaints.allow("404")
    await description.publish(String("<robot>\n<link/></robot>"))
    await expect(row).to_contain_text("line 2")
    await scene.shows({})
