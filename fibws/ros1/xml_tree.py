"""XML as a tree that knows its lines; no document in it can reach beyond itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Generic, Self, TypeVar
from xml.parsers import expat

from fibws.errors import FibwsError

MOST_LEVELS = 100
"""Of elements in each other: a document that a person wrote has a handful."""


@dataclass
class Element(ABC):
    """One element; each kind of document has a subclass, which knows the error that tells of it.

    Attributes:
        line: the number of the line that it begins in.
        text: what stands in it and in its children, as it is written.
    """

    name: str
    attributes: dict[str, str]
    file: str
    line: int
    children: list[Self] = field(default_factory=list)
    text: str = ""

    def all(self, name: str) -> list[Self]:
        """The children of that name."""
        return [child for child in self.children if child.name == name]

    @abstractmethod
    def fault(self, text: str) -> FibwsError:
        """An error that tells where this element stands."""


_Kind = TypeVar("_Kind", bound=Element)


def read(document: bytes, file: str, kind: type[_Kind]) -> _Kind:
    """The root of a document.

    Args:
        document: the text, in the encoding that it says it has, else UTF-8.
        file: what it is called in errors.
        kind: the class of its elements.

    Raises:
        FibwsError: what ``kind.fault`` makes. It is no XML, its elements are too deep in each
            other, or it has a DOCTYPE, which could name entities and other files.
    """
    reader = _Reader(file, kind)
    try:
        reader.parser.Parse(document, True)
    except FibwsError:
        raise
    except expat.ExpatError as error:
        text = f"this is no XML: {expat.ErrorString(error.code)}{_shown(document, error.lineno)}"
        raise reader.fault(error.lineno, text) from None
    except (ValueError, LookupError) as error:
        # Python reads encodings of which every character is one byte, and UTF-8 and 16.
        raise reader.fault(1, f"write this file in UTF-8: {error}") from None
    assert reader.root is not None, "expat has found no fault"
    return reader.root


def _shown(document: bytes, line: int) -> str:
    """The line in question, which says more than the parser's words."""
    lines = document.decode(errors="replace").splitlines()
    return f": {lines[line - 1].strip()[:80]}" if 0 < line <= len(lines) else ""


class _Reader(Generic[_Kind]):
    """Builds the tree while expat reads."""

    def __init__(self, file: str, kind: type[_Kind]) -> None:
        self._file = file
        self._kind = kind
        self._open: list[_Kind] = []
        self.root: _Kind | None = None
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True  # A text comes whole, not in thousands of pieces.
        self.parser.buffer_size = 2**20
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype

    def fault(self, line: int, text: str) -> FibwsError:
        return self._kind("", {}, self._file, line).fault(text)

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = self._kind(name, attributes, self._file, self.parser.CurrentLineNumber)
        if len(self._open) >= MOST_LEVELS:
            raise element.fault(f"there are more than {MOST_LEVELS} tags in each other")
        if self._open:
            self._open[-1].children.append(element)
        else:
            self.root = element
        self._open.append(element)

    def _end(self, name: str) -> None:
        element = self._open.pop()
        if self._open:
            self._open[-1].text += element.text

    def _text(self, text: str) -> None:
        self._open[-1].text += text

    def _doctype(self, *_: object) -> None:
        line = self.parser.CurrentLineNumber
        raise self.fault(line, "a DOCTYPE is not read here: leave it out")
