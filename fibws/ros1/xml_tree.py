"""XML trees with line numbers; DOCTYPEs, which could refer to other files, are refused."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Generic, Self, TypeVar
from xml.parsers import expat
from xml.parsers.expat import errors

from fibws.errors import FibwsError

MOST_LEVELS = 100
"""Limit of nested elements; documents that people write have a few."""
_NAME = re.compile(rb"[\w:.-]+")
_CLOSED_VALUE = re.compile(rb"""=\s*("[^"]*"|'[^']*')""")


@dataclass
class Element(ABC):
    """An element; each kind of document has a subclass, which creates the errors.

    Attributes:
        line: the number of its first line.
        text: its text and that of its children.
    """

    name: str
    attributes: dict[str, str]
    file: str
    line: int
    children: list[Self] = field(default_factory=list)
    text: str = ""

    def all(self, name: str) -> list[Self]:
        """Return the children of this name."""
        return [child for child in self.children if child.name == name]

    @abstractmethod
    def fault(self, text: str) -> FibwsError:
        """Return an error that names the file and the line of this element."""


_Kind = TypeVar("_Kind", bound=Element)


def read(document: bytes, file: str, kind: type[_Kind]) -> _Kind:
    """Parse a document and return its root.

    Args:
        document: the text, in its declared encoding, by default UTF-8.
        file: its name in errors.
        kind: the class of its elements.

    Raises:
        FibwsError: the error of ``kind.fault``: the XML is invalid, its elements are nested too
            deeply, or it has a DOCTYPE.
    """
    reader = _Reader(file, kind)
    try:
        reader.parser.Parse(document, True)
    except FibwsError:
        raise
    except expat.ExpatError as error:
        line, cause = reader.mistake(error, document)
        raise reader.fault(line, f"invalid XML: {cause}{_shown(document, line)}") from None
    except (ValueError, LookupError) as error:
        # Python's expat supports UTF-8, UTF-16 and single-byte encodings.
        raise reader.fault(1, f"unsupported encoding, write this file in UTF-8: {error}") from None
    assert reader.root is not None, "expat reports an error for an empty document"
    return reader.root


def _shown(document: bytes, line: int) -> str:
    """Return the invalid line for the end of an error."""
    lines = document.decode(errors="replace").splitlines()
    return f": {lines[line - 1].strip()[:80]}" if 0 < line <= len(lines) else ""


def _unclosed(text: bytes) -> str:
    """Return what is missing in a text that should be a start tag; empty if that is unknown."""
    name = _NAME.match(text, 1)
    rest = _CLOSED_VALUE.sub(b"", text)
    if name is None or b">" in rest.partition(b'"')[0].partition(b"'")[0]:
        return ""
    tag = f"<{name[0].decode(errors='replace')}>"
    if b'"' in rest or b"'" in rest:
        return f"{tag} has a value with an unclosed quotation mark, or with a < (write &lt;)"
    return f"{tag} has no > at its end"


class _Reader(Generic[_Kind]):
    """Builds the tree while expat reads."""

    def __init__(self, file: str, kind: type[_Kind]) -> None:
        self._file = file
        self._kind = kind
        self._open: list[_Kind] = []
        self.root: _Kind | None = None
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True  # Otherwise a text arrives in many pieces.
        self.parser.buffer_size = 2**20
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype

    def fault(self, line: int, text: str) -> FibwsError:
        return self._kind("", {}, self._file, line).fault(text)

    def mistake(self, error: expat.ExpatError, document: bytes) -> tuple[int, str]:
        """Return the line of a mistake, and its description.

        expat names the line where it stopped, which may be far below an unclosed tag.
        """
        if b"\0" in document:  # UTF-16, in which tags are not looked for
            return error.lineno, expat.ErrorString(error.code)
        where = self.parser.ErrorByteIndex
        match expat.ErrorString(error.code):
            case errors.XML_ERROR_NO_ELEMENTS if self._open:
                return self._open[-1].line, f"<{self._open[-1].name}> is not closed"
            case errors.XML_ERROR_TAG_MISMATCH if found := _NAME.match(document, where):
                return self._mismatch(error.lineno, found[0].decode(errors="replace"))
            case errors.XML_ERROR_UNCLOSED_TOKEN if document.startswith(b"<!--", where):
                return error.lineno, "comment is not closed: missing -->"
            case errors.XML_ERROR_UNCLOSED_TOKEN if text := _unclosed(document[where:]):
                return error.lineno, text
            case errors.XML_ERROR_INVALID_TOKEN if document.startswith(b"<", where):
                start = max(document.rfind(b"<", 0, where), 0)
                if text := _unclosed(document[start:where]):
                    return document.count(b"\n", 0, start) + 1, text
            case _:
                pass
        return error.lineno, expat.ErrorString(error.code)

    def _mismatch(self, line: int, name: str) -> tuple[int, str]:
        """Return the line and the description for an end tag that does not fit."""
        inner = self._open[-1]
        if any(element.name == name for element in self._open):
            return inner.line, f"<{inner.name}> is not closed before </{name}> in line {line}"
        return line, f"expected </{inner.name}> for line {inner.line}, got </{name}>"

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        element = self._kind(name, attributes, self._file, self.parser.CurrentLineNumber)
        if len(self._open) >= MOST_LEVELS:
            raise element.fault(f"tags are nested too deeply (limit {MOST_LEVELS})")
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
        raise self.fault(line, "DOCTYPE is not supported: remove it")
