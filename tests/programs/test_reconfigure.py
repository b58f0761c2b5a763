"""A server of parameters, and `dynparam`, which changes them."""

from __future__ import annotations

from pathlib import Path

import pytest
from running_programs import Start

from fibws.hub.server import HubServer

SERVER = Path(__file__).parents[1] / "ros1" / "scripts" / "reconfigure" / "server.py"


@pytest.mark.long
async def test_dynparam_changes_the_parameters_of_a_server(
    hub: HubServer, start: Start, tmp_path: Path
) -> None:
    url = hub.url
    server = await start("fibws.rospy", str(SERVER), FIBWS_HUB=url)
    while "ready" not in await server.line():
        pass

    async def dynparam(*words: str) -> str:
        program = await start(
            "fibws", "run", "dynamic_reconfigure", "dynparam", *words, FIBWS_HUB=url
        )
        _, out, err = await program.end()
        return out + err

    assert (await dynparam("list")).split() == ["/server", "/server/second"]
    assert await dynparam("set", "server", "size", "large") == ""
    assert await dynparam("set", "server", "double_param", "-3") == ""
    assert await dynparam("set", "server", "{str_param: hey, bool_param: no}") == ""
    found = await dynparam("get", "server")
    assert all(each in found for each in ("'size': 2", "'double_param': 0.0", "'hey'", "False"))
    assert "nope" in await dynparam("set", "server", "nope", "1")
    file = tmp_path / "saved.yaml"
    await dynparam("dump", "server", str(file))
    assert "size: 2" in file.read_text()
    file.write_text("int_param: 3")
    await dynparam("load", "server", str(file))
    assert hub.graph.parameters.get("/server/int_param") == 3
