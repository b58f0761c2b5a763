"""tf_remap, and view_frames of another node."""

from __future__ import annotations

import pytest
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.geometry_msgs import TransformStamped
from fibws.msg.std_msgs import Header
from fibws.msg.tf2_msgs import TFMessage

REMAP = ("fibws", "run", "tf", "tf_remap")


async def test_frames_get_other_names(hub: HubServer, start: Start) -> None:
    mappings = [{"old": "/body", "new": "base_link"}, {"old": "laser", "new": "/lidar"}]
    hub.graph.parameters.set("/tf_remapper/mappings", mappings)
    async with fibws.Node("test", hub=hub.url) as node:
        old = await node.advertise("/tf_old", TFMessage, peers=True)
        new = node.subscribe("/tf", TFMessage)
        await start(*REMAP, FIBWS_HUB=hub.url)
        async for names in old.peers.changes():
            if names:
                break
        pairs = [("map", "body"), ("/body", "laser")]
        transforms = [TransformStamped(Header(frame_id=each), child) for each, child in pairs]
        await old.publish(TFMessage(transforms))
        found = [
            (each.header.frame_id, each.child_frame_id) for each in (await anext(new)).transforms
        ]
        assert found == [("map", "base_link"), ("base_link", "lidar")]


@pytest.mark.parametrize("mappings", [5, [5], [{"old": "a"}], [{"old": "a", "new": 7}]])
@pytest.mark.long
async def test_invalid_mappings_are_an_error(
    hub: HubServer, start: Start, mappings: object
) -> None:
    hub.graph.parameters.set("/tf_remapper/mappings", mappings)
    code, _, err = await (await start(*REMAP, FIBWS_HUB=hub.url)).end()
    assert code == 1 and "~mappings must" in err
