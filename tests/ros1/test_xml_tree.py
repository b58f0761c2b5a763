"""XML trees."""

from __future__ import annotations

import pytest

from fibws.ros1.errors import LaunchError
from fibws.ros1.xml_tree import MOST_LEVELS, Element, read


class Tag(Element):
    def fault(self, text: str) -> LaunchError:
        return LaunchError(self.file, self.line, text)


def test_element_has_attributes_children_text_and_line() -> None:
    root = read(b'<a>\n <b c="d"\n  e="f">x</b>\n <!-- no --> y<i/></a>', "a.xml", Tag)
    [inner] = root.all("b")
    assert (root.name, root.file, root.line, root.text) == ("a", "a.xml", 1, "\n x\n  y")
    assert (inner.name, inner.attributes, inner.line) == ("b", {"c": "d", "e": "f"}, 2)
    assert [type(child) for child in root.children] == [Tag, Tag]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "iso-8859-1", "cp1252"])
def test_declared_encoding_is_used(encoding: str) -> None:
    name = encoding.removesuffix("-sig")
    text = f'<?xml version="1.0" encoding="{name}"?><a b="Grüße"/>'
    assert read(text.encode(encoding), "a.xml", Tag).attributes == {"b": "Grüße"}


@pytest.mark.parametrize(
    ("document", "line", "fact"),
    [
        (b"", 1, "no element found"),
        (b"<a>\n<b>\n\n</a>", 2, "<b> is not closed before </a> in line 4"),
        (b"<a>\n<b>\n<c/>\n", 2, "<b> is not closed"),
        (b"<a>\n</c>\n</a>", 2, "expected </a> for line 1, got </c>"),
        (b"<a>\n<b c='d'\n</a>", 2, "<b> has no >"),
        (b"<a>\n<b c='d'\n", 2, "<b> has no >"),
        (b'<a>\n<b c="d/>\n<b c="e"/></a>', 2, "quotation mark"),
        (b'<a>\n<b c="d" e="f < g"/></a>', 2, "&lt;"),
        (b"<a>\n<!-- b\n</a>", 2, "-->"),
        (b"<a>\n</b <c>", 2, "invalid token"),
        ("<aa>\n<b>\n</aa>".encode("utf-16"), 3, "mismatched tag"),
        (b"<a>\n<b name=a/></a>", 2, "<b name=a/></a>"),
        (b"<a>\xff</a>", 1, "invalid token"),
        (b'<?xml version="1.0" encoding="klingon"?><a/>', 1, "UTF-8"),
        (b'<?xml version="1.0" encoding="gb2312"?><a/>', 1, "UTF-8"),
    ],
)
def test_error_about_invalid_xml_names_the_line(document: bytes, line: int, fact: str) -> None:
    with pytest.raises(LaunchError) as raised:
        read(document, "a.xml", Tag)
    assert str(raised.value).startswith(f"a.xml:{line}: ")
    assert fact in str(raised.value)


BOMB = b"""<!DOCTYPE lolz [
 <!ENTITY a "aaaaaaaaaa">
 <!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">
]><a>&b;</a>"""
OTHER_FILE = b'<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]><a>&a;</a>'
OTHER_DOCTYPE = b'<!DOCTYPE a SYSTEM "http://localhost/a.dtd"><a/>'


@pytest.mark.parametrize("document", [BOMB, OTHER_FILE, OTHER_DOCTYPE, b"<!DOCTYPE a><a/>"])
def test_doctype_is_refused(document: bytes) -> None:
    with pytest.raises(LaunchError, match=r"a\.xml:1: .*DOCTYPE"):
        read(document, "a.xml", Tag)


def test_nesting_is_limited() -> None:
    deep = b"<a>" * MOST_LEVELS + b"</a>" * MOST_LEVELS
    read(deep, "a.xml", Tag)
    with pytest.raises(LaunchError, match=str(MOST_LEVELS)):
        read(b"<a>" + deep + b"</a>", "a.xml", Tag)


def test_long_text_is_read_fast() -> None:
    text = "&amp;" * 500_000
    assert read(f"<a>{text}</a>".encode(), "a.xml", Tag).text == "&" * 500_000
