"""What the publishers, or the subscribers, of one topic share in a process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Coroutine
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from rospy import core
from rospy.exceptions import ROSInterruptException

if TYPE_CHECKING:
    from genpy import Message

    from fibws.node.peers import Peers

PATIENCE = 1.0
"""Most seconds to wait for a response of the hub, for example while there is none."""

T = TypeVar("T")


class _Impl(Protocol):
    resolved_name: str
    data_class: type[Message]

    def close(self) -> None: ...


Impl = TypeVar("Impl", bound=_Impl)


class Shared(Generic[Impl]):
    """Keeps one object for each topic and message class while it is used.

    Args:
        make: creates an object from the topic's global name and the class.
    """

    def __init__(self, make: Callable[[str, type[Message]], Impl]) -> None:
        self._make = make
        self._lock = threading.RLock()
        self._users: dict[Impl, int] = {}

    def acquire(self, resolved_name: str, data_class: type[Message]) -> Impl:
        """Return the topic's object; `release` it once."""
        with self._lock:
            for impl in self._users:
                if impl.resolved_name == resolved_name and impl.data_class is data_class:
                    break
            else:
                impl = self._make(resolved_name, data_class)
            self._users[impl] = self._users.get(impl, 0) + 1
            return impl

    def release(self, impl: Impl) -> None:
        """Stop using an object; the last user's release closes it."""
        with self._lock:
            self._users[impl] -= 1
            if self._users[impl]:
                return
            del self._users[impl]
        impl.close()

    def close_all(self, reason: str) -> None:
        """Close the objects of all topics: the node has ended.

        They release the program's callbacks, so that ``__del__`` methods run while modules exist.
        """
        with self._lock:
            impls = list(self._users)
        for impl in impls:
            impl.close()


def ask(question: Coroutine[Any, Any, T], default: T) -> T:
    """Return the hub's response, or the default if it does not respond in time, or refuses.

    Args:
        question: asks the hub.
        default: the default.
    """
    from fibws.errors import FibwsError

    try:
        return core.background.call(question, PATIENCE)
    except (FibwsError, TimeoutError, ROSInterruptException):
        return default


def count_peers(peers: Peers, question: Coroutine[Any, Any, list[str]]) -> int:
    """Return how many nodes are at the other side of a topic.

    Args:
        peers: the nodes as the hub reports them.
        question: asks a rosbridge_suite server for them, which does not report them.
    """
    if peers.told:
        question.close()
        return len(peers.names)
    return len(ask(question, []))
