"""XML as a tree."""

from __future__ import annotations

import pytest

from fibws.errors import LaunchError
from fibws.ros1.xml_tree import MOST_LEVELS, Element, read


class Tag(Element):
    def fault(self, text: str) -> LaunchError:
        return LaunchError(self.file, self.line, text)


def test_an_element_has_attributes_children_text_and_the_line_it_begins_in() -> None:
    root = read(b'<a>\n <b c="d"\n  e="f">x</b>\n <!-- no --> y<i/></a>', "a.xml", Tag)
    [inner] = root.all("b")
    assert (root.name, root.file, root.line, root.text) == ("a", "a.xml", 1, "\n x\n  y")
    assert (inner.name, inner.attributes, inner.line) == ("b", {"c": "d", "e": "f"}, 2)
    assert [type(child) for child in root.children] == [Tag, Tag]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1", "cp1252"])
def test_a_document_may_say_its_encoding(encoding: str) -> None:
    name = encoding.removesuffix("-sig")
    text = f'<?xml version="1.0" encoding="{name}"?><a b="Grüße"/>'
    assert read(text.encode(encoding), "a.xml", Tag).attributes == {"b": "Grüße"}


@pytest.mark.parametrize(
    ("document", "error"),
    [
        (b"", "a.xml:1: this is no XML: no element found"),
        (b"<a>\n<b>\n</a>", "a.xml:3: this is no XML: mismatched tag: </a>"),
        (
            b"<a>\n<b name=a/></a>",
            "a.xml:2: this is no XML: not well-formed (invalid token): <b name=a/></a>",
        ),
        (b"<a>\xff</a>", "a.xml:1: this is no XML: not well-formed (invalid token)"),
        (b'<?xml version="1.0" encoding="klingon"?><a/>', "a.xml:1: write this file in UTF-8:"),
        (b'<?xml version="1.0" encoding="gb2312"?><a/>', "a.xml:1: write this file in UTF-8:"),
    ],
)
def test_what_is_no_xml_is_an_error_that_names_the_line(document: bytes, error: str) -> None:
    with pytest.raises(LaunchError) as raised:
        read(document, "a.xml", Tag)
    assert str(raised.value).startswith(error)


BOMB = b"""<!DOCTYPE lolz [
 <!ENTITY a "aaaaaaaaaa">
 <!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
]><a>&b;</a>"""
OTHER_FILE = b'<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]><a>&a;</a>'
OTHER_DOCTYPE = b'<!DOCTYPE a SYSTEM "http://localhost/a.dtd"><a/>'


@pytest.mark.parametrize("document", [BOMB, OTHER_FILE, OTHER_DOCTYPE, b"<!DOCTYPE a><a/>"])
def test_no_document_reaches_beyond_itself(document: bytes) -> None:
    with pytest.raises(LaunchError, match=r"a\.xml:1: a DOCTYPE is not read here"):
        read(document, "a.xml", Tag)


def test_elements_cannot_be_too_deep_in_each_other() -> None:
    deep = b"<a>" * MOST_LEVELS + b"</a>" * MOST_LEVELS
    read(deep, "a.xml", Tag)
    with pytest.raises(LaunchError, match="in each other"):
        read(b"<a>" + deep + b"</a>", "a.xml", Tag)


def test_a_long_text_is_read_in_no_time() -> None:
    text = "&amp;" * 500_000
    assert read(f"<a>{text}</a>".encode(), "a.xml", Tag).text == "&" * 500_000
