"""The types that a node speaks."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

import fibws
import fibws.msg
from fibws.interfaces import Interfaces
from fibws.msg import _finder
from fibws.msg.std_msgs import Int32
from fibws.node.types import NodeTypes
from fibws.srv.rospy_tutorials import AddTwoInts

from .conftest import ScriptedHub


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of the user's, with a package ``garden``."""
    messages = tmp_path / "garden" / "msg"
    messages.mkdir(parents=True)
    (messages / "Bed.msg").write_text("string crop\nPlant[] plants\n")
    (messages / "Plant.msg").write_text("float32 height\n")
    services = tmp_path / "garden" / "srv"
    services.mkdir()
    (services / "Water.srv").write_text("Plant plant\n---\nfloat32 litres\n")
    return tmp_path


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let each test begin with the standard types alone."""
    monkeypatch.setattr(_finder, "_interfaces", Interfaces())
    monkeypatch.delenv("FIBWS_INTERFACES", raising=False)


def types() -> NodeTypes:
    return NodeTypes(time.time_ns)


def test_class_is_found_by_the_name_of_its_type() -> None:
    assert types().message_class("std_msgs/Int32") is Int32
    assert types().message_class(Int32) is Int32


def test_invalid_type_is_refused() -> None:
    class Lost(fibws.Message):
        _type = "garden/Lost"

    with pytest.raises(fibws.InterfaceError, match="garden"):
        types().message_class("garden/Bed")
    with pytest.raises(fibws.InterfaceError, match="garden"):
        types().message_class(Lost)


def test_received_message_is_validated() -> None:
    read = types().codec(Int32).read
    assert read({"data": 5}) == Int32(5)
    assert read({}) == Int32(0)
    with pytest.raises(fibws.InvalidMessage):
        read({"data": 2**31})


def test_definitions_are_sent_only_for_nonstandard_types(folder: Path) -> None:
    fibws.msg.add_folder(folder)
    mine = types()
    assert mine.definition("std_msgs/Int32") is None
    text = mine.definition("garden/Bed")
    assert text is not None
    assert text.startswith("string crop\nPlant[] plants\n")
    assert "MSG: garden/Plant" in text


def test_service_is_found_by_the_name_of_its_type() -> None:
    assert types().service_class("rospy_tutorials/AddTwoInts") is AddTwoInts
    assert types().service_class(AddTwoInts) is AddTwoInts
    with pytest.raises(fibws.InterfaceError, match="garden"):
        types().service_class("garden/Water")


def test_invalid_service_type_is_refused() -> None:
    with pytest.raises(fibws.InterfaceError, match="Int32"):
        types().service(Int32)  # type: ignore[arg-type]


def test_definitions_are_sent_only_for_nonstandard_services(folder: Path) -> None:
    fibws.msg.add_folder(folder)
    mine = types()
    assert mine.service_definition("rospy_tutorials/AddTwoInts") is None
    text = mine.service_definition("garden/Water")
    assert text is not None
    assert text.startswith("Plant plant\n---\nfloat32 litres\n")
    assert "MSG: garden/Plant" in text


async def test_definition_is_sent_with_the_advertisement(
    hub: ScriptedHub, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FIBWS_INTERFACES", str(folder))
    async with fibws.Node("gardener", hub=hub.url) as node:
        peer = await hub.peer()
        beds = await node.advertise("beds", "garden/Bed")
        await beds.publish("beans", [])
        assert "MSG: garden/Plant" in (await peer.expect("advertise"))["definition"]
        assert (await peer.expect("publish"))["msg"] == {"crop": "beans", "plants": []}


@pytest.mark.parametrize("given", [Int32(), int, 5, None])
def test_other_things_than_classes_and_names_are_refused(given: Any) -> None:
    types = NodeTypes(lambda: 0)
    for find in (types.message_class, types.service_class, types.action_class):
        with pytest.raises(TypeError, match="class or the name of a type, such as"):
            find(given)
