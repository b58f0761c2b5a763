"""Keys, tokens and attachments of rmw_zenoh."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import Ros2Error
from fibws.hub.ros2.key_layout import (
    Attachment,
    Entity,
    Qos,
    data_key,
    dds_type,
    gid_of,
    is_left_out,
    is_legal,
    parse_dds_type,
    tokens_key,
)

from .peer import ADD, ADD_HASH, STRING, STRING_HASH

NODE = "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"
PUBLISHER = (
    "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%robot%arm/talker/%chatter/"
    f"{STRING}/{STRING_HASH}/::,7:,:,:,,"
)


def test_token_of_a_node() -> None:
    entity = Entity.parse(NODE)
    assert (entity.kind, entity.node, entity.domain) == ("NN", "/listener", 2)
    assert entity.session == "aac3178e146ba6f1fc6e6a4085e77f21"
    assert entity.token() == NODE


def test_token_of_a_publisher() -> None:
    entity = Entity.parse(PUBLISHER)
    assert (entity.kind, entity.node, entity.name) == ("MP", "/robot/arm/talker", "/chatter")
    assert (entity.type, entity.type_hash) == ("std_msgs/String", STRING_HASH)
    assert entity.qos == Qos(depth=7)
    assert entity.token() == PUBLISHER


def test_token_of_a_service() -> None:
    token = f"@ros2_lv/0/ab/1/2/SS/%/%/adder/%math%add/{ADD}/{ADD_HASH}/::,10:,:,:,,"
    entity = Entity.parse(token)
    assert (entity.kind, entity.name, entity.type) == (
        "SS",
        "/math/add",
        "example_interfaces/AddTwoInts",
    )
    assert entity.token() == token


def test_parts_of_later_releases_are_ignored() -> None:
    entity = Entity.parse(f"{PUBLISHER}:more/cpu;gpu")
    assert entity.qos.depth == 7


@pytest.mark.parametrize(
    "token",
    [
        "",
        "@ros2_lv/0",
        NODE.replace("@ros2_lv", "@other"),
        NODE.replace("/NN/", "/XX/"),
        NODE.replace("lv/2/", "lv/two/"),
        NODE.replace("listener", "1listener"),
        NODE.replace("/NN/", "/MP/"),
        PUBLISHER.replace("/MP/", "/SS/"),
        PUBLISHER.replace("%chatter", "chatter"),
        PUBLISHER.replace("%chatter", "%chat-ter"),
        PUBLISHER.replace("dds_::String_", "String"),
        PUBLISHER.replace("RIHS01_", "RIHS02_"),
        PUBLISHER.replace("::,7:,:,:,,", "::,seven:,:,:,,"),
        PUBLISHER.replace("::,7:,:,:,,", "::"),
        PUBLISHER.replace("chatter", "c" * 2000),
    ],
)
def test_invalid_token_is_refused(token: str) -> None:
    with pytest.raises(Ros2Error, match=r"invalid|not a type"):
        Entity.parse(token)


@given(st.text(max_size=50), st.integers(0, 12), st.sampled_from([NODE, PUBLISHER]))
def test_any_token_is_read_or_refused(text: str, index: int, token: str) -> None:
    parts = token.split("/")
    parts[index % len(parts)] = text
    try:
        entity = Entity.parse("/".join(parts))
    except Ros2Error:
        return
    assert is_legal(entity.node)
    assert Entity.parse(entity.token()) == entity


@pytest.mark.parametrize(
    ("text", "qos"),
    [
        ("::,:,:,:,,", Qos()),
        ("2:1:,5:,:,:,,", Qos(is_reliable=False, is_latched=True, depth=5)),
        ("1:2:1,42:9,9:,:1,,", Qos()),
        ("::2,:,:,:,,", Qos()),
        ("::,3000000000:,:,:,,", Qos(depth=3_000_000_000)),
        (f"::,{2**64 - 1}:,:,:,,", Qos(depth=2**64 - 1)),
    ],
)
def test_qos(text: str, qos: Qos) -> None:
    assert Qos.parse(text) == qos
    assert Qos.parse(str(qos)) == qos


def test_attachment() -> None:
    attachment = Attachment(5, 1_700_000_000_000_000_000, bytes(range(16)))
    data = attachment.pack()
    assert len(data) == 33
    assert data[16] == 16
    assert Attachment.parse(data) == attachment


@given(st.binary(max_size=80))
def test_any_attachment_is_read_or_refused(data: bytes) -> None:
    try:
        attachment = Attachment.parse(data)
    except Ros2Error:
        return
    assert attachment.pack() == data


def test_attachment_of_old_releases_is_named_in_the_error() -> None:
    with pytest.raises(Ros2Error, match=r"before 0\.2\.4"):
        Attachment.parse(bytes(77))


def test_gid_is_the_hash_of_the_token() -> None:
    # XXH3 of 128 bits of "" is 99aa06d3014798d86001c324468d497f.
    assert gid_of("").hex() == bytes.fromhex("99aa06d3014798d86001c324468d497f")[::-1].hex()
    assert len(gid_of(PUBLISHER)) == 16


def test_keys() -> None:
    key = data_key(0, "/robot/chatter", "msg", "std_msgs/String", STRING_HASH)
    assert key == f"0/robot/chatter/{STRING}/{STRING_HASH}"
    assert data_key(3, "/add", "srv", "example_interfaces/AddTwoInts", ADD_HASH) == (
        f"3/add/{ADD}/{ADD_HASH}"
    )
    assert tokens_key(3) == "@ros2_lv/3/**"


def test_names_of_types() -> None:
    assert dds_type("msg", "std_msgs/String") == STRING
    assert parse_dds_type(STRING) == ("msg", "std_msgs/String")
    with pytest.raises(Ros2Error, match="invalid type"):
        parse_dds_type("std_msgs/msg/String")


def test_names() -> None:
    assert is_legal("/_ros2cli_1/chatter_2")
    assert not is_legal("/a-b")
    assert not is_legal("chatter")
    assert not is_legal("/" + "a" * 300)
    assert is_left_out("/walk/_action/feedback")
    assert is_left_out("/add/_service_event")
    assert not is_left_out("/walk/action")
    assert not is_left_out("/service_event")
