"""XML as a tree of tags that know their file and line; no document can reach beyond itself."""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

from fibws.errors import LaunchError

MOST_LEVELS = 100
"""Of tags in each other: a launch file has a handful."""


@dataclass
class Tag:
    """One tag.

    Attributes:
        text: what stands in it, as it is written, but not in its children.
        line: the number of the line that it begins in.
    """

    name: str
    attributes: dict[str, str]
    file: str
    line: int
    children: list[Tag] = field(default_factory=list)
    text: str = ""

    def fault(self, text: str) -> LaunchError:
        """An error that tells where this tag stands."""
        return LaunchError(self.file, self.line, text)


def read(document: bytes, file: str) -> Tag:
    """The root of a document.

    Args:
        document: the text, in the encoding that it says it has, else UTF-8.
        file: what it is called in errors.

    Raises:
        LaunchError: it is no XML, or has a DOCTYPE, which could name entities and other files.
    """
    reader = _Reader(file)
    try:
        reader.parser.Parse(document, True)
    except expat.ExpatError as error:
        fault = f"this is no XML: {expat.ErrorString(error.code)}"
        raise LaunchError(file, error.lineno, fault + _hint(document, error)) from None
    except (ValueError, LookupError) as error:  # an encoding that Python does not have
        if isinstance(error, LaunchError):
            raise
        raise LaunchError(file, 1, f"this is no XML: {error}") from None
    return reader.root


def _hint(document: bytes, error: expat.ExpatError) -> str:
    """What the error's words do not say: which tag is open, whose quotation marks lack."""
    lines = document.decode(errors="replace").splitlines()
    if not 0 < error.lineno <= len(lines):
        return ""
    return f": {lines[error.lineno - 1].strip()[:80]}"


class _Reader:
    """Builds the tree while expat reads."""

    def __init__(self, file: str) -> None:
        self._file = file
        self._open: list[Tag] = []
        self.root = Tag("", {}, file, 1)
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._text
        self.parser.StartDoctypeDeclHandler = self._doctype

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        tag = Tag(name, attributes, self._file, self.parser.CurrentLineNumber)
        if len(self._open) >= MOST_LEVELS:
            raise tag.fault(f"there are more than {MOST_LEVELS} tags in each other")
        if self._open:
            self._open[-1].children.append(tag)
        else:
            self.root = tag
        self._open.append(tag)

    def _end(self, name: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        self._open[-1].text += text

    def _doctype(self, *_: object) -> None:
        line = self.parser.CurrentLineNumber
        raise LaunchError(self._file, line, "a DOCTYPE is not read here: leave it out")
