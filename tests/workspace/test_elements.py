"""XML with lines."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.errors import PackageFileError
from fibws.workspace.elements import read_elements


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "package.xml"


def test_an_element_knows_its_line_and_its_text(file: Path) -> None:
    file.write_text("<a>\n  <b x='1'>one\n two <i>three</i></b>\n  <b/>\n</a>")
    root = read_elements(file)
    first, second = root.all("b")
    assert (first.line, first.text, first.attributes) == (2, "one two three", {"x": "1"})
    assert (second.line, second.text) == (4, "")


def test_what_is_no_xml_is_told_with_its_line(file: Path) -> None:
    file.write_text("<a>\n<b></a>")
    with pytest.raises(PackageFileError, match=r"package\.xml, line 2: this is no XML: mismatched"):
        read_elements(file)


@pytest.mark.parametrize(
    "doctype",
    [
        '<!DOCTYPE a [<!ENTITY b "c">]>',
        '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE a SYSTEM "http://localhost/a.dtd">',
    ],
)
def test_no_document_reaches_beyond_itself(file: Path, doctype: str) -> None:
    file.write_text(f"<?xml version='1.0'?>\n{doctype}\n<a>&b;</a>")
    with pytest.raises(PackageFileError, match="line 2: a DOCTYPE is not read here"):
        read_elements(file)


@pytest.mark.parametrize("encoding", ["gb2312", "qwertz"])
def test_an_encoding_that_nobody_reads_is_told(file: Path, encoding: str) -> None:
    file.write_bytes(f"<?xml version='1.0' encoding='{encoding}'?><a/>".encode())
    with pytest.raises(PackageFileError, match=r"package\.xml, line 1: "):
        read_elements(file)


def test_an_encoding_that_the_file_names_is_heeded(file: Path) -> None:
    file.write_bytes("<?xml version='1.0' encoding='iso-8859-1'?><a>é</a>".encode("latin-1"))
    assert read_elements(file).text == "é"
