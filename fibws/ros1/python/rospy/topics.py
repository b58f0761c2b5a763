"""`Publisher` and `Subscriber`."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from rospy import core, names
from rospy.exceptions import ROSException, ROSInterruptException
from rospy.impl.tcpros_base import DEFAULT_BUFF_SIZE
from rospy.msg import Message, args_kwds_to_message
from rospy.publication import Publication
from rospy.rostime import seconds_of
from rospy.subscription import Subscription

if TYPE_CHECKING:
    from rospy.rostime import Duration


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


S = TypeVar("S", Publication, Subscription)

_publications = Shared(Publication)
_subscriptions = Shared(Subscription)
core.add_shutdown_hook(_subscriptions.close_all)


class Topic(Generic[S]):
    """The base of `Publisher` and `Subscriber`.

    Attributes:
        resolved_name: the topic's global name; None after `unregister`, as those that follow.
        type: the type's name, such as ``std_msgs/String``.
        md5sum: the fingerprint of the type's definition.
        data_class: the class of the messages.
        impl: the state that all publishers, or all subscribers, of the topic share.
    """

    def __init__(self, name: str, data_class: type[Message], shared: Shared[S]) -> None:
        _check(name, data_class)
        if core.is_initialized():
            resolved = names.resolve_name(name)
        else:
            resolved = names.resolve_name_without_node_name(name)
        self.name = resolved
        self.resolved_name: str | None = resolved
        self.data_class: type[Message] | None = data_class
        self.type: str | None = data_class._type
        self.md5sum: str | None = data_class._md5sum
        self._shared: Shared[S] = shared
        self.impl: S | None = shared.acquire(resolved, data_class)

    def get_num_connections(self) -> int:
        """Return how many nodes are at the other side of the topic.

        Raises:
            ROSException: it was unregistered.
        """
        if self.impl is None:
            raise ROSException("get_num_connections() of an unregistered() handle")
        return self.impl.get_num_connections()

    def unregister(self) -> None:
        """Leave the topic. Does nothing when called again."""
        impl, self.impl = self.impl, None
        if impl is not None:
            self.resolved_name = self.type = self.md5sum = self.data_class = None
            self._shared.release(impl)


class Subscriber(Topic[Subscription]):
    """Calls a function with each message of a topic, in a thread of the topic's own.

    Args:
        name: the topic's name.
        data_class: the class of its messages, or `AnyMsg` for messages of any type.
        callback: takes the message, and ``callback_args`` if that is not None.
        callback_args: an additional argument of the callback.
        queue_size: how many messages wait for slow callbacks; more drop the oldest. None for no
            limit except one that protects the memory.
        buff_size: has no effect.
        tcp_nodelay: has no effect.

    Raises:
        ValueError: the name or the class is invalid.
        ROSException: the queue size is invalid.
    """

    def __init__(
        self,
        name: str,
        data_class: type[Message],
        callback: Callable[..., object] | None = None,
        callback_args: Any = None,
        queue_size: int | None = None,
        buff_size: int = DEFAULT_BUFF_SIZE,
        tcp_nodelay: bool = False,
    ) -> None:
        super().__init__(name, data_class, _subscriptions)
        self.callback = callback
        self.callback_args = callback_args
        impl = self.impl
        assert impl is not None
        if queue_size is not None:
            impl.set_queue_size(queue_size)
        if callback is not None:
            impl.add_callback(callback, callback_args)
        core.on_start(impl.register)

    def unregister(self) -> None:
        """Stop calling the callback. Does nothing when called again."""
        if self.impl is not None and self.callback is not None:
            self.impl.remove_callback(self.callback, self.callback_args)
        self.callback = self.callback_args = None
        super().unregister()


class SubscribeListener:
    """Called when nodes subscribe to a `Publisher`'s topic; programs override its methods."""

    def peer_subscribe(
        self,
        topic_name: str,
        topic_publish: Callable[[Any], None],
        peer_publish: Callable[[Any], None],
    ) -> None:
        """A node has subscribed.

        Args:
            topic_name: the topic's global name.
            topic_publish: publishes a message to all subscribers.
            peer_publish: publishes a message to that node alone.
        """

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """A node has unsubscribed.

        Args:
            topic_name: the topic's global name.
            num_peers: how many subscribers are left.
        """


class Publisher(Topic[Publication]):
    """Publishes messages on a topic.

    Args:
        name: the topic's name.
        data_class: the class of its messages.
        subscriber_listener: is called when nodes subscribe and unsubscribe.
        tcp_nodelay: has no effect.
        latch: whether the last message is kept for later subscribers.
        headers: fields for the ``_connection_header`` of the messages.
        queue_size: how many messages are kept while the network is slow; more drop the oldest.
            With None `publish` waits for the network.

    Raises:
        ValueError: the name or the class is invalid.
    """

    def __init__(
        self,
        name: str,
        data_class: type[Message],
        subscriber_listener: SubscribeListener | None = None,
        tcp_nodelay: bool = False,
        latch: bool = False,
        headers: dict[str, str] | None = None,
        queue_size: int | None = None,
    ) -> None:
        super().__init__(name, data_class, _publications)
        impl = self.impl
        assert impl is not None
        if subscriber_listener:
            impl.listeners.append(subscriber_listener)
        impl.latch = impl.latch or latch
        impl.headers.update(headers or {})
        if queue_size is not None:
            impl.queue_size = int(queue_size)  # Scripts give 10.0, and numpy's numbers.
        else:
            warnings.warn(
                "The publisher should be created with an explicit keyword argument 'queue_size'. "
                "Please see http://wiki.ros.org/rospy/Overview/Publishers%20and%20Subscribers "
                "for more information.",
                SyntaxWarning,
                stacklevel=2,
            )
        core.on_start(impl.register)

    def publish(self, *args: Any, **kwds: Any) -> None:
        """Publish a message, or one of the given fields, in order or by name.

        Raises:
            ROSException: there is no node yet, or the publisher was unregistered.
            ROSSerializationException: a field does not fit the type.
            TypeError: fields both in order and by name, or a message of another class.
        """
        if self.impl is None or self.data_class is None:
            raise ROSException("publish() to an unregistered() handle")
        if not core.is_initialized():
            raise ROSException(
                "ROS node has not been initialized yet. Please call init_node() first"
            )
        message: Any = args_kwds_to_message(self.data_class, args, kwds)
        if isinstance(message, type):
            name = message.__name__
            raise TypeError(f"expected a message but got the class {name}: write {name}()")
        self.impl.publish(message)


def wait_for_message(
    topic: str, topic_type: type[Message], timeout: float | Duration | None = None
) -> Any:
    """Wait for one message of a topic.

    Args:
        topic: its name.
        topic_type: the class of its messages.
        timeout: the most seconds to wait, or a `Duration`; None for ever.

    Raises:
        ROSException: there was no message in time.
        ROSInterruptException: the node ends.
    """
    messages: list[Message] = []

    def take(message: Message) -> None:
        messages.append(message)
        core.wakeup.wake_all()

    subscriber = Subscriber(topic, topic_type, take)
    try:
        core.wakeup.wait(lambda: bool(messages) or core.is_shutdown(), seconds_of(timeout))
    finally:
        subscriber.unregister()
    if core.is_shutdown():
        raise ROSInterruptException("rospy shutdown")
    if not messages:
        raise ROSException(f"timeout exceeded while waiting for message on topic {topic}")
    return messages[0]


def _check(name: object, data_class: object) -> None:
    """Raise ValueError unless these are a topic's name and a message class."""
    if not isinstance(name, str) or not name:
        raise ValueError("topic name is not a non-empty string")
    if data_class is None:
        raise ValueError("topic parameter 'data_class' is not initialized")
    if not isinstance(data_class, type):
        raise ValueError(f"data_class [{data_class}] is not a class")
    if not issubclass(data_class, Message):
        kind = data_class.__class__.__name__
        raise ValueError(f"data_class [{kind}] is not a message data class")
    names.warn_unless_legal(name, stacklevel=5)
