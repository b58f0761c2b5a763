"""The bases of the Python classes that stand for services and actions, which `generator` writes.

No objects are made of these: a class tells which messages belong together, to people and to type
checkers. A function that takes a ``type[Service[Req, Res]]`` and a ``Req`` may give a ``Res``.
"""

from __future__ import annotations

from typing import Any, ClassVar, Generic

from typing_extensions import TypeVar

from fibws.interfaces.message import Message

Req = TypeVar("Req", bound=Message, default=Any)
Res = TypeVar("Res", bound=Message, default=Any)
G = TypeVar("G", bound=Message, default=Any)
R = TypeVar("R", bound=Message, default=Any)
F = TypeVar("F", bound=Message, default=Any)


class Service(Generic[Req, Res]):
    """A service: ``AddTwoInts.Request(a=1, b=2)`` asks, an ``AddTwoInts.Response`` answers."""

    _type: ClassVar[str]
    Request: type[Req]
    Response: type[Res]

    def __init_subclass__(cls) -> None:
        for name in ("Request", "Response"):
            if name in cls.__dict__:
                cls.__dict__[name]._service = cls._type


class Action(Generic[G, R, F]):
    """An action: a ``Goal`` is sent, ``Feedback`` is heard, and a ``Result`` ends it."""

    _type: ClassVar[str]
    Goal: type[G]
    Result: type[R]
    Feedback: type[F]
