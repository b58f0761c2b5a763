"""XML as a tree of tags."""

from __future__ import annotations

import pytest

from fibws.errors import LaunchError
from fibws.launch.tag import MOST_LEVELS, read


def test_a_tag_has_attributes_children_text_and_the_line_it_begins_in() -> None:
    root = read(b'<launch>\n <node name="a"\n  pkg="p"/>\n <!-- no -->x</launch>', "a.launch")
    [node] = root.children
    assert (root.name, root.line, root.text) == ("launch", 1, "\n \n x")
    assert (node.name, node.attributes, node.line) == ("node", {"name": "a", "pkg": "p"}, 2)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1", "cp1252"])
def test_a_document_may_say_its_encoding(encoding: str) -> None:
    text = f'<?xml version="1.0" encoding="{encoding}"?><launch a="Grüße"/>'
    assert read(text.encode(encoding), "a.launch").attributes == {"a": "Grüße"}


@pytest.mark.parametrize(
    ("document", "error"),
    [
        (b"", "a.launch:1: this is no XML: no element found"),
        (b"<launch>\n<node>\n</launch>", "a.launch:3: this is no XML: mismatched tag: </launch>"),
        (
            b"<launch>\n<node name=a/></launch>",
            "a.launch:2: this is no XML: not well-formed (invalid token): <node name=a/></launch>",
        ),
        (b"<launch>\xff</launch>", "a.launch:1: this is no XML: not well-formed (invalid token)"),
        (b'<?xml version="1.0" encoding="klingon"?><launch/>', "a.launch:1: this is no XML:"),
    ],
)
def test_what_is_no_xml_is_an_error_that_names_the_line(document: bytes, error: str) -> None:
    with pytest.raises(LaunchError) as raised:
        read(document, "a.launch")
    assert str(raised.value).startswith(error)


BOMB = b"""<!DOCTYPE lolz [
 <!ENTITY a "aaaaaaaaaa">
 <!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
]><launch>&b;</launch>"""
OTHER_FILE = b'<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]><launch>&a;</launch>'


@pytest.mark.parametrize("document", [BOMB, OTHER_FILE, b"<!DOCTYPE launch><launch/>"])
def test_no_document_can_define_entities(document: bytes) -> None:
    with pytest.raises(LaunchError, match=r"a\.launch:1: a DOCTYPE is not read here"):
        read(document, "a.launch")


def test_tags_cannot_be_too_deep_in_each_other() -> None:
    deep = b"<group>" * MOST_LEVELS + b"</group>" * MOST_LEVELS
    read(deep, "a.launch")
    with pytest.raises(LaunchError, match="in each other"):
        read(b"<launch>" + deep + b"</launch>", "a.launch")
