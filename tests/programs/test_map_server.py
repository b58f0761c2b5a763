"""map_server and map_saver."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from patience import PATIENCE
from running_programs import Start

import fibws
from fibws.hub.server import HubServer
from fibws.msg.nav_msgs import MapMetaData, OccupancyGrid

YAML = "image: a.pgm\nresolution: 0.5\norigin: [1, 2, {}]\nnegate: 0\n"
YAML += "occupied_thresh: 0.65\nfree_thresh: 0.196\n"


def map_of(folder: Path, *pixels: int, yaw: float = 0.0) -> Path:
    folder.mkdir()
    (folder / "a.pgm").write_bytes(b"P5 2 %d 255\n" % (len(pixels) // 2) + bytes(pixels))
    file = folder / "a.yaml"
    file.write_text(YAML.format(yaw))
    return file


async def test_map_is_served_changed_and_saved(
    hub: HubServer, start: Start, tmp_path: Path
) -> None:
    first = map_of(tmp_path / "first", 0, 254, 205, 0, yaw=1.0)
    other = map_of(tmp_path / "other", 0, 254)
    server = ("fibws", "run", "map_server", "map_server")
    await start(*server, str(first), "_frame_id:=world", FIBWS_HUB=hub.url)
    async with fibws.Node("test", hub=hub.url) as node:
        grids = node.subscribe("/map", OccupancyGrid)
        grid = await anext(grids)
        assert list(grid.data) == [-1, 100, 100, 0]
        assert grid.header.frame_id == "world"
        info = grid.info
        assert (info.width, info.height, info.resolution) == (2, 2, 0.5)
        assert (info.origin.position.x, info.origin.position.y) == (1.0, 2.0)
        assert (info.origin.orientation.z, info.origin.orientation.w) == (
            math.sin(0.5),
            math.cos(0.5),
        )
        assert await node.wait_for_message("/map_metadata", MapMetaData) == info
        await node.wait_for_service("/change_map", timeout=PATIENCE)
        served = await node.call("/static_map", "nav_msgs/GetMap")
        assert list(served.map.data) == list(grid.data)

        changed = await node.call("/change_map", "nav_msgs/LoadMap", {"map_url": str(other)})
        assert (changed.result, list(changed.map.data)) == (0, [100, 0])
        assert list((await anext(grids)).data) == [100, 0]
        for url, result in (("/none.yaml", 1), (str(other.with_name("a.pgm")), 3)):
            failed = await node.call("/change_map", "nav_msgs/LoadMap", {"map_url": url})
            assert (failed.result, list(failed.map.data)) == (result, [])

        saver = await start(
            *("fibws", "run", "map_server", "map_saver", "-f", str(tmp_path / "saved")),
            FIBWS_HUB=hub.url,
        )
        code, out, err = await saver.end()
        assert (code, err) == (0, "")
        assert "Received a 2 X 1 map @ 0.500 m/pix" in out
        assert (tmp_path / "saved.pgm").read_bytes().endswith(b"2 1\n255\n\x00\xfe")
        assert "origin: [1.000000, 2.000000, 0.000000]" in (tmp_path / "saved.yaml").read_text()


@pytest.mark.long
async def test_invalid_arguments_are_errors(start: Start, tmp_path: Path) -> None:
    server = ("fibws", "run", "map_server", "map_server")
    code, _, err = await (await start(*server, str(tmp_path / "none.yaml"))).end()
    assert code == 1 and "none.yaml: No such file" in err
    saver = ("fibws", "run", "map_server", "map_saver")
    for words in (["--occ", "200"], ["--occ", "20"], ["-f"], ["--fre", "1"]):
        code, _, err = await (await start(*saver, *words)).end()
        assert code == 1 and ("must be" in err or "usage: map_saver" in err)
