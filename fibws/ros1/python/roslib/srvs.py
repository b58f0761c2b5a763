"""Definitions of services: http://wiki.ros.org/srv."""

from __future__ import annotations

from pathlib import Path

from roslib import msgs, names

EXT = ".srv"
SEP = "/"
IODELIM = "---"
COMMENTCHAR = msgs.COMMENTCHAR


class SrvSpecException(Exception):
    """A definition is invalid."""


class SrvSpec:
    """The definition of a service: those of its request and its response."""

    def __init__(
        self,
        request: msgs.MsgSpec,
        response: msgs.MsgSpec,
        text: str,
        full_name: str = "",
        short_name: str = "",
        package: str = "",
    ) -> None:
        self.request = request
        self.response = response
        self.text = text
        self.full_name = full_name
        self.short_name = short_name
        self.package = package

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SrvSpec):
            return False
        mine = (self.request, self.response, self.text)
        return mine == (other.request, other.response, other.text)

    __hash__ = None  # type: ignore[assignment]  # As in ROS.

    def __repr__(self) -> str:
        return f"SrvSpec[{self.request!r}, {self.response!r}]"


def load_from_string(
    text: str, package_context: str = "", full_name: str = "", short_name: str = ""
) -> SrvSpec:
    """Return the definition that a text has; see `roslib.msgs.load_from_string`.

    Raises:
        SrvSpecException: the text does not have two parts.
        MsgSpecException: a part is invalid.
    """
    lines = text.split("\n")
    marks = [index for index, line in enumerate(lines) if line.startswith(IODELIM)]
    if len(marks) != 1:
        raise SrvSpecException(f"expected one line {IODELIM}, got {len(marks)}")
    parts = ("\n".join(lines[: marks[0]]), "\n".join(lines[marks[0] + 1 :]))
    request, response = (
        msgs.load_from_string(part, package_context, full_name + suffix, short_name + suffix)
        for part, suffix in zip(parts, ("Request", "Response"), strict=True)
    )
    return SrvSpec(request, response, text, full_name, short_name, package_context)


def load_from_file(file_name: str, package_context: str = "") -> tuple[str, SrvSpec]:
    """Return the type that a .srv file defines, and its definition; as `load_from_string`.

    Raises:
        OSError: the file cannot be read.
    """
    short = Path(file_name).name.removesuffix(EXT)
    package = package_context.rstrip(SEP)
    type_ = names.resource_name(package, short)
    text = Path(file_name).read_text(encoding="utf-8")
    return type_, load_from_string(text, package, type_, short)
