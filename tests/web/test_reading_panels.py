"""Joints, attitudes, batteries and positions on the pages of their topics."""

from __future__ import annotations

import math

from playwright.async_api import expect

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import Quaternion, Vector3
from fibws.msg.sensor_msgs import BatteryState, Imu, JointState, NavSatFix, NavSatStatus

from .conftest import OpenPage

URDF = """<robot name="arm">
  <link name="base"/> <link name="leg"/> <link name="hand"/> <link name="top"/>
  <joint name="hip" type="revolute">
    <parent link="base"/> <child link="leg"/>
    <limit lower="-1" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="spin" type="continuous"> <parent link="base"/> <child link="top"/> </joint>
  <joint name="lift" type="prismatic">
    <parent link="leg"/> <child link="hand"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/>
  </joint>
</robot>"""


async def test_joints_are_bars_between_their_limits(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("arm", hub=hub.url) as node:
        await node.params.set("/robot_description", URDF)
        topic = await node.advertise("/joint_states", JointState, latch=True)
        message = JointState(
            name=["lift", "hip", "spin", "wheel_10", "wheel_9"],
            position=[0.75, 1, 0.5, 40, math.nan],
            velocity=[0, 0.25, 0, 0, 0],
        )
        await topic.publish(message)
        page = await open_page(hub, "#/topics/%2Fjoint_states")
        rows = page.locator(".joints tbody tr")
        await expect(rows).to_have_count(5)
        hip = rows.nth(0)
        await expect(hip.locator("td")).to_have_text(
            ["", "1.000 rad", "0.250 rad/s", "\N{EN DASH}"]
        )
        await expect(rows.nth(1).get_by_text("beyond its limit")).to_be_visible()
        await expect(hip.locator(".joint-note")).to_be_hidden()
        await expect(rows.nth(1)).to_contain_text("0.750 m")
        await expect(rows.locator("th")).to_contain_text(
            ["hip", "lift", "spin", "wheel_9", "wheel_10"]
        )
        # From 0, a quarter of the range, to 1, half of it.
        bar = hip.locator(".joint-bar")
        style = await bar.evaluate("(bar) => bar.style.cssText")
        assert style == "--from: 25.0%; --length: 25.0%;"
        # What turns on and on has no bar: by its type, or as it has turned too far for one.
        for name in ("spin", "wheel_10"):
            row = rows.filter(has=page.get_by_text(name, exact=True))
            await expect(row.locator(".joint-bar")).to_be_hidden()
        await expect(rows.filter(has_text="spin")).to_contain_text("0.500 rad")
        # Another node publishes other joints of the robot.
        await topic.publish(JointState(name=["head"], position=[0.5]))
        await expect(rows).to_have_count(6)
        await expect(rows.filter(has_text="head").locator(".joint-bar")).to_be_visible()


async def test_joints_of_a_broken_description_have_no_limits(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with fibws.Node("arm", hub=hub.url) as node:
        await node.params.set("/robot_description", "<robot><link/></robot>")
        topic = await node.advertise("/joint_states", JointState, latch=True)
        await topic.publish(JointState(name=["hip"], position=[1]))
        page = await open_page(hub, "#/topics/%2Fjoint_states")
        await expect(page.locator(".joints td.number").first).to_have_text("1.000")
        await expect(page.get_by_text("No limits: /robot_description is invalid")).to_be_visible()


async def test_attitude_has_a_horizon(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("imu", hub=hub.url) as node:
        topic = await node.advertise("/imu", Imu, latch=True)
        half = math.radians(30) / 2
        nose_down = Quaternion(y=math.sin(half), w=math.cos(half))
        await topic.publish(Imu(orientation=nose_down))
        page = await open_page(hub, "#/topics/%2Fimu", color_scheme="dark")
        picture = page.get_by_role("img", name="Roll 0\N{DEGREE SIGN}, pitch 30\N{DEGREE SIGN}")
        await expect(picture).to_be_visible()
        ground = picture.locator("g").first
        await expect(ground).to_have_attribute("transform", "rotate(0.0) translate(0 -30.0)")
        # Without an orientation, gravity tells where up is: the left side is up here.
        unknown = [-1.0, *[0.0] * 8]
        tilted = Vector3(y=9.8 * math.sin(0.5), z=9.8 * math.cos(0.5))
        await topic.publish(Imu(orientation_covariance=unknown, linear_acceleration=tilted))
        await expect(page.locator(".reading-facts")).to_contain_text("fromacceleration")
        await expect(page.locator(".horizon g")).to_have_attribute(
            "transform", "rotate(-28.6) translate(0 0.0)"
        )


async def test_battery_says_its_charge_and_what_is_unknown(
    hub: HubServer, open_page: OpenPage
) -> None:
    async with fibws.Node("base", hub=hub.url) as node:
        topic = await node.advertise("/battery", BatteryState, latch=True)
        await topic.publish(
            BatteryState(
                percentage=0.1,
                voltage=11.1,
                current=math.nan,
                power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
                cell_voltage=[3.75, 3.5],
            )
        )
        page = await open_page(hub, "#/topics/%2Fbattery")
        await expect(page.locator(".battery-percent")).to_contain_text("10 %")
        await expect(page.locator(".battery-percent")).to_contain_text("nearly empty")
        facts = page.locator(".reading-facts")
        await expect(facts).to_contain_text("statedischarging")
        await expect(facts).to_contain_text("weakest cell3.50 V")
        await expect(facts).not_to_contain_text("current")
        await topic.publish(BatteryState(percentage=math.nan))
        await expect(page.locator(".battery-percent")).to_have_text("charge unknown")


async def test_position_has_a_track(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("gps", hub=hub.url) as node:
        topic = await node.advertise("/fix", NavSatFix, latch=True)
        page = await open_page(hub, "#/topics/%2Ffix")
        await expect(page.locator(".reading")).to_contain_text("No message yet")
        no_fix = NavSatStatus(status=NavSatStatus.STATUS_NO_FIX)
        await topic.publish(NavSatFix(status=no_fix, latitude=1, longitude=1))
        await expect(page.locator(".reading-facts")).to_contain_text("no fix")
        here = page.locator(".track-here")
        for east in range(3):
            await topic.publish(NavSatFix(latitude=50, longitude=8 + east * 1e-4))
            label = f"now {round(east * 7.156)} m east and 0 m north"
            await expect(page.get_by_role("img", name=label)).to_be_visible()
        await expect(page.locator(".reading-facts")).to_contain_text("from the start14.3 m")
        assert float(await here.get_attribute("cx") or 0) > 80


async def test_reading_without_a_publisher_says_so(hub: HubServer, open_page: OpenPage) -> None:
    async with fibws.Node("listener", hub=hub.url) as node:
        node.subscribe("/imu", Imu)
        await node.flush()
        page = await open_page(hub, "#/topics/%2Fimu")
        await expect(page.locator(".reading")).to_contain_text("no node publishes /imu")
