"""rosmsg's functions for scripts: the types of packages and their definitions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fibws.errors import InterfaceError

if TYPE_CHECKING:
    from fibws.values.type_definitions import InstalledTypes

__all__ = [
    "MODE_MSG",
    "MODE_SRV",
    "ROSMsgException",
    "get_msg_text",
    "get_srv_text",
    "iterate_packages",
    "list_msgs",
    "list_srvs",
    "list_types",
]

MODE_MSG = ".msg"
MODE_SRV = ".srv"


class ROSMsgException(Exception):
    """The type is unknown, or its definition is invalid."""


def get_msg_text(type_: str, raw: bool = False, rospack: object = None) -> str:
    """Return the fields of a message type in the format of ``rosmsg show``.

    Args:
        type_: such as ``std_msgs/String``.
        raw: return the text of its file instead, with comments.
        rospack: has no effect.

    Raises:
        ROSMsgException: the type is unknown, or its definition is invalid.
    """
    return _text(MODE_MSG, type_, raw)


def get_srv_text(type_: str, raw: bool = False, rospack: object = None) -> str:
    """Return the fields of a service type; otherwise like `get_msg_text`."""
    return _text(MODE_SRV, type_, raw)


def list_msgs(package: str, rospack: object = None) -> list[str]:
    """Return the message types of a package, ``std_msgs/String``; none if it is unknown."""
    return list_types(package, MODE_MSG)


def list_srvs(package: str, rospack: object = None) -> list[str]:
    """Return the service types of a package; none if it is unknown."""
    return list_types(package, MODE_SRV)


def list_types(package: str, mode: str = MODE_MSG, rospack: object = None) -> list[str]:
    """Return the message or service types of a package; none if it is unknown."""
    try:
        return _installed(mode).names(package)
    except InterfaceError:
        return []


def iterate_packages(rospack: object, mode: str) -> Iterator[tuple[str, str]]:
    """Yield the packages that have types, each with the folder of its definitions.

    Args:
        rospack: has no effect; the packages are those of $ROS_PACKAGE_PATH and of fibws.
        mode: `MODE_MSG` or `MODE_SRV`.
    """
    from fibws.ros1.workspace.packages import Packages

    known = Packages.from_environment()
    for name in _installed(mode).packages():
        if known.has(name):
            yield name, f"{known.find(name).folder}/{mode.removeprefix('.')}"


def _text(mode: str, type_: str, raw: bool) -> str:
    try:
        shown = _installed(mode).definition(type_)
    except InterfaceError as error:
        raise ROSMsgException(f"Unable to load {mode[1:]} [{type_}]: {error}") from None
    return shown.text if raw else "".join(f"{line}\n" for line in shown.lines)


def _installed(mode: str) -> InstalledTypes:
    from fibws.values.type_definitions import InstalledTypes

    if mode == MODE_MSG:
        return InstalledTypes("msg", ())
    if mode == MODE_SRV:
        return InstalledTypes("srv", ())
    raise ROSMsgException(f"Invalid mode for list_types: {mode}")
