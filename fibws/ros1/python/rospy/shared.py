"""What publishers, or subscribers, of the same topic share in a process."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from genpy import Message


class _Impl(Protocol):
    resolved_name: str
    data_class: type[Message]

    def close(self) -> None: ...


Impl = TypeVar("Impl", bound=_Impl)


class Shared(Generic[Impl]):
    """One object for each topic and class of messages, as long as somebody uses it.

    Args:
        make: makes one, given the topic's global name and the class.
    """

    def __init__(self, make: Callable[[str, type[Message]], Impl]) -> None:
        self._make = make
        self._lock = threading.RLock()
        self._users: dict[Impl, int] = {}

    def acquire(self, resolved_name: str, data_class: type[Message]) -> Impl:
        """The object of the topic; it is to be released once."""
        with self._lock:
            for impl in self._users:
                if impl.resolved_name == resolved_name and impl.data_class is data_class:
                    break
            else:
                impl = self._make(resolved_name, data_class)
            self._users[impl] = self._users.get(impl, 0) + 1
            return impl

    def release(self, impl: Impl) -> None:
        """Use the object no more; it is closed if nobody does."""
        with self._lock:
            self._users[impl] -= 1
            if self._users[impl]:
                return
            del self._users[impl]
        impl.close()

    def close_all(self, reason: str) -> None:
        """Close the objects of all topics, since the node has ended.

        They let go of what they have of the program's, so that its ``__del__`` are called while
        they can still do something.
        """
        with self._lock:
            impls = list(self._users)
        for impl in impls:
            impl.close()
