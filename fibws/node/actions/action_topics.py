"""The five topics of an action: two lead to its server, three to its clients.

Their messages are actionlib's: http://wiki.ros.org/actionlib/DetailedDescription.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, NamedTuple

from fibws.errors import NodeError, OperationRejected
from fibws.interfaces import Message
from fibws.node.actions.actions import Actions
from fibws.node.subscription import Subscription
from fibws.node.topics import Topics
from fibws.protocol.operations import Advertise, Publish, Subscribe, encode


class Kind(NamedTuple):
    """One of the topics: its name behind the action's, and its type, to be filled in."""

    name: str
    type: str


GOAL = Kind("goal", "{action}ActionGoal")
CANCEL = Kind("cancel", "actionlib_msgs/GoalID")
STATUS = Kind("status", "actionlib_msgs/GoalStatusArray")
FEEDBACK = Kind("feedback", "{action}ActionFeedback")
RESULT = Kind("result", "{action}ActionResult")


class ActionTopics:
    """The topics of one action, for one end of it.

    Args:
        actions: the node's.
        name: the action's global name.
        type_: the action's type.
        refused: is told if the hub does not let this node have one of the topics.
    """

    def __init__(
        self,
        actions: Actions,
        name: str,
        type_: str,
        refused: Callable[[NodeError], None],
    ) -> None:
        self._session = actions.session
        self._topics = actions.topics
        self._types = actions.types
        self._name = name
        self._type = type_
        self._refused = refused
        self._senders: list[Sender] = []
        self._receivers: list[Receiver] = []

    def sender(self, kind: Kind, *, queue_size: int, latch: bool = False) -> Sender:
        """Begin to publish on a topic."""
        topic, type_ = f"{self._name}/{kind.name}", kind.type.format(action=self._type)
        operation = Advertise(
            id=self._session.id("advertise", topic),
            topic=topic,
            type=type_,
            queue_size=queue_size,
            latch=latch,
            definition=self._types.definition(type_),
        )
        validate = self._types.validate(type_)
        sender = Sender(self._topics, operation, validate, self._refused)
        self._senders.append(sender)
        return sender

    def receiver(self, kind: Kind, take: Callable[[Any], None], *, queue_size: int) -> None:
        """Begin to listen to a topic, and have ``take`` given each message."""
        topic, type_ = f"{self._name}/{kind.name}", kind.type.format(action=self._type)
        operation = Subscribe(
            id=self._session.id("subscribe", topic),
            topic=topic,
            type=type_,
            queue_length=queue_size,
        )
        read = self._types.wire(self._types.message_class(type_)).read
        receiver = Receiver(operation, read, self._topics, self._session.log, take, self._refused)
        self._topics.subscribe(receiver)
        self._receivers.append(receiver)

    def close(self) -> None:
        """Publish and listen no more."""
        for sender in self._senders:
            sender.close()
        for receiver in self._receivers:
            receiver.close()


class Sender:
    """The sending end of one of the topics.

    It waits for nothing, so that a goal's last word is said even while the node ends.
    """

    def __init__(
        self,
        topics: Topics,
        operation: Advertise,
        validate: Callable[[Any], dict[str, Any]],
        refused: Callable[[NodeError], None],
    ) -> None:
        self._topics = topics
        self._validate = validate
        self._advertisement = topics.advertise(operation, refused)

    def put(self, **fields: Any) -> None:
        """Publish a message of these fields; a header's stamp is the time."""
        advertisement = self._advertisement
        if advertisement.closed:
            return
        text = encode(Publish(topic=advertisement.operation.topic, msg=self._validate(fields)))
        self._topics.put(advertisement, text)

    def close(self) -> None:
        """Publish no more."""
        self._topics.unadvertise(self._advertisement)


class Receiver(Subscription[Message]):
    """The receiving end of one of the topics.

    It keeps nothing for a reader, but hands each message on as it comes: so those of several topics
    stay in order, and a goal's feedback is heard before its result.
    """

    def __init__(
        self,
        operation: Subscribe,
        read: Callable[[Any], Message],
        topics: Topics,
        log: logging.Logger,
        take: Callable[[Any], None],
        refused: Callable[[NodeError], None],
    ) -> None:
        super().__init__(operation, str(operation.type), 1, read, topics.unsubscribe, log)
        self._refused = refused
        self.hand_to(take)

    def end(self, fault: Exception | None = None) -> None:
        """Nothing more will come."""
        super().end(fault)
        if isinstance(fault, OperationRejected):
            self._refused(fault)
