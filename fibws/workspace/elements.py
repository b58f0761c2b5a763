"""XML as a tree that knows its lines; no document in it can reach beyond itself."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from fibws.errors import PackageFileError


@dataclass
class Element:
    """One element.

    Attributes:
        text: what stands in it and its children, its blanks made single.
        line: the number of the line that it begins in.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    text: str = ""

    def all(self, tag: str) -> list[Element]:
        """The children of that tag."""
        return [child for child in self.children if child.tag == tag]


def read_elements(path: Path) -> Element:
    """The root element of a file.

    Raises:
        PackageFileError: it is no XML, or has a DOCTYPE, which could name entities and other files.
    """
    reader = _Reader(str(path))
    try:
        reader.parser.Parse(path.read_bytes(), True)
    except expat.ExpatError as error:
        fault = f"this is no XML: {expat.ErrorString(error.code)}"
        raise PackageFileError(str(path), error.lineno, fault) from None
    except (ValueError, LookupError) as error:
        # Python reads encodings of which every character is one byte, and UTF-8 and 16.
        if isinstance(error, PackageFileError):
            raise
        raise PackageFileError(str(path), 1, f"write this file in UTF-8: {error}") from None
    return reader.root


class _Reader:
    """Builds the tree while expat reads."""

    def __init__(self, source: str) -> None:
        self._source = source
        self._open: list[Element] = []
        self.root = Element("", {}, 1)
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, self.parser.CurrentLineNumber)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, tag: str) -> None:
        element = self._open.pop()
        if self._open:
            self._open[-1].text += element.text
        element.text = " ".join(element.text.split())

    def _text(self, text: str) -> None:
        self._open[-1].text += text

    def _doctype(self, *_: object) -> None:
        line = self.parser.CurrentLineNumber
        raise PackageFileError(self._source, line, "a DOCTYPE is not read here: leave it out")
