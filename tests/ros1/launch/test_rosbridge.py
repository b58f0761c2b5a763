"""rosbridge_websocket in launch files."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.ros1.errors import LaunchError
from fibws.ros1.launch.rosbridge import rosbridges

from .conftest import Read
from .packages import package

START = '<node pkg="rosbridge_server" type="rosbridge_websocket" name="r"'


@pytest.mark.parametrize(
    ("text", "port"),
    [
        (f"{START}/>", None),
        (f'{START}><param name="port" value="9091"/></node>', 9091),
        (f'{START}><param name="port" type="str" value="0"/></node>', 0),
        (f'{START} args="--port 9092"><param name="port" value="9091"/></node>', 9092),
        (f'{START} args="--port"><param name="port" value=""/></node>', None),
        (f'{START} args="--port \'9092"/>', None),
        (f'<param name="/g/r/port" value="7"/><group ns="g">{START}/></group>', 7),
        (START.replace("socket", "socket.py") + ' args="--port 1"/>', 1),
    ],
)
def test_port_of_rosbridge(text: str, port: int | None, read: Read, tmp_path: Path) -> None:
    [found] = rosbridges(read(text), package(tmp_path))
    assert found.port == port
    assert found.place.startswith("main.launch:2: r")


def test_other_nodes_have_no_port(read: Read, tmp_path: Path) -> None:
    launch = read(
        START.replace("_websocket", "_tcp") + ' args="--port 1"/>'
        '<node pkg="robot" type="rosbridge_websocket" name="n" args="--port 2"/>'
    )
    assert not list(rosbridges(launch, package(tmp_path)))
    own = package(tmp_path / "own", "rosbridge_server")
    assert not list(rosbridges(read(f'{START} args="--port 1"/>'), own))


@pytest.mark.parametrize("port", ["x", "-1", "65536", "1.5", "true"])
def test_invalid_port_is_an_error(port: str, read: Read, tmp_path: Path) -> None:
    launch = read(f'{START}><param name="port" value="{port}"/></node>')
    with pytest.raises(LaunchError, match=r"main.launch:2: .* between 0 and 65535, got"):
        list(rosbridges(launch, package(tmp_path)))


@pytest.mark.parametrize(
    ("settings", "facts"),
    [
        (
            {"address": "0.0.0.0", "authenticate": "true", "certfile": "/c.pem"},
            ["fibws hub --host 0.0.0.0", "/c.pem", "authenticate"],
        ),
        ({"address": "localhost", "authenticate": "false", "certfile": ""}, []),
    ],
)
def test_settings_that_the_hub_ignores_are_known(
    settings: dict[str, str], facts: list[str], read: Read, tmp_path: Path
) -> None:
    params = "".join(f'<param name="{name}" value="{each}"/>' for name, each in settings.items())
    [found] = rosbridges(read(f"{START}>{params}</node>"), package(tmp_path))
    assert len(found.ignored) == len(facts)
    assert set(facts) == {fact for fact in facts if any(fact in text for text in found.ignored)}
