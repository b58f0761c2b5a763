"""A node: one program's, or one part's, place on the ROS graph."""

from __future__ import annotations

import asyncio
import logging
import os
import time
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, Self, overload

from typing_extensions import TypeVar

from fibws import names
from fibws.interfaces import Action, Message, Service, Time
from fibws.interfaces.message import F, G, R, Req, Res
from fibws.node import address
from fibws.node.calls import Calls
from fibws.node.connection import Connection
from fibws.node.identity import Identity
from fibws.node.limits import UNBOUNDED_QUEUE, check_queue_size, check_timeout
from fibws.node.log import FORMAT, node_log
from fibws.node.loggers import Loggers
from fibws.node.publisher import P, Publisher
from fibws.node.rate import Rate
from fibws.node.rosapi import Rosapi
from fibws.node.rosout import Rosout
from fibws.node.service import Handler, HeaderHandler, ServiceServer
from fibws.node.services import Services
from fibws.node.session import Session
from fibws.node.subscription import Subscription
from fibws.node.topics import Topics
from fibws.node.types import Types
from fibws.node.waiting import wait_for_message, wait_for_service
from fibws.protocol.headers import check_headers
from fibws.protocol.operations import Advertise, Subscribe

if TYPE_CHECKING:
    from fibws.node.actions.actions import Actions
    from fibws.node.actions.client import ActionClient
    from fibws.node.actions.over import Over
    from fibws.node.actions.server import ActionServer, Execute
    from fibws.node.graph import Graph
    from fibws.node.params import Params

M = TypeVar("M", bound=Message, default=Any)

NO_REMAPPING = names.Remapping()


class Node:
    """One place on the ROS graph: ``async with fibws.Node("talker") as node``.

    Entering, which is done once, waits until the hub answers. Leaving sends what still waits if
    that takes no more than 0.6 s, and logs a warning with the number of messages that were not. In
    between the node finds its hub again whenever that goes away, and registers with it as before.

    All names that a node is given are resolved and remapped as ROS does it
    (http://wiki.ros.org/Names). Beside the errors that each of its methods names there may be
    `InvalidName` for a name that is not legal, `InterfaceError` for a type that nobody defined, and
    `NodeClosed` once the node has ended, or what ended it. What waits for the hub, and is called
    before the node is entered, raises RuntimeError.

    Args:
        name: a name with no namespace in it; a remapping of ``__name`` goes before it.
        hub: ``ws://host:port`` or ``host:port``; else $FIBWS_HUB, else this machine.
        anonymous: make the name one that no other node has.
        namespace: where relative names belong; else $ROS_NAMESPACE, else ``/``.
        remapping: what the command line renames.
        log_format: the console's line, as ROSCONSOLE_FORMAT writes it; else that variable.
        log: the logger to use, with its own level and handlers, rather than one of the node's own
            that writes to the console.
        rosout: whether what is logged is published on /rosout.

    Raises:
        InvalidName: a name is not legal.
        InvalidAddress: the hub's address is none.
    """

    def __init__(
        self,
        name: str,
        *,
        hub: str | None = None,
        anonymous: bool = False,
        namespace: str | None = None,
        remapping: names.Remapping = NO_REMAPPING,
        log_format: str | None = None,
        log: logging.Logger | None = None,
        rosout: bool = True,
    ) -> None:
        self._identity = Identity.choose(
            name, anonymous=anonymous, namespace=namespace, remapping=remapping
        )
        environment = os.environ
        self._hub = address.hub_url(hub)
        self._types = Types(time.time_ns)
        self.log = log or node_log(
            self.name, log_format or environment.get("ROSCONSOLE_FORMAT") or FORMAT
        )
        """The node's logger: what it is told goes to the console, and from the entering on to
        /rosout."""
        self._session = Session(self.log)
        self._calls = Calls(self._session, self._types)
        self._services = Services(self._session, self._types)
        self._topics = Topics(self._session)  # Last: what is latched ends the greeting.
        self._rosout = Rosout(self.name, self._topics) if rosout else None
        self._loggers = Loggers(self.log, self._services, self.resolve)
        self._connection = Connection(self._hub, self.name, self._session, self.log)

    def __repr__(self) -> str:
        return f"<Node {self.name} at {self._hub}>"

    @property
    def name(self) -> str:
        """The node's global name, such as ``/robot/talker``."""
        return self._identity.name

    @property
    def namespace(self) -> str:
        """The namespace that relative names belong to."""
        return self._identity.namespace

    @property
    def hub(self) -> str:
        """The URL of the node's hub."""
        return self._hub

    def resolve(self, name: str) -> str:
        """The global name that ``name`` stands for here, remappings included."""
        return self._identity.resolve(name)

    @cached_property
    def params(self) -> Params:
        """The parameters that all nodes share."""
        from fibws.node.params import Params  # Its types take 10 ms to load, and few nodes use it.

        return Params(Rosapi(self._calls), self.resolve)

    @cached_property
    def graph(self) -> Graph:
        """What is known of the other nodes, of topics and services."""
        from fibws.node.graph import Graph  # As for params.

        return Graph(Rosapi(self._calls), self.resolve)

    def now(self) -> Time:
        """The time of day."""
        return Time.from_nanoseconds(time.time_ns())

    async def advertise(
        self,
        topic: str,
        type: Callable[P, M] | str,
        *,
        queue_size: int = 10,
        latch: bool = False,
        headers: Mapping[str, str] | None = None,
        peers: bool = False,
    ) -> Publisher[M, P]:
        """Begin to publish on a topic.

        If the hub refuses, the next publish raises OperationRejected.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            queue_size: how many messages are kept while there is no hub.
            latch: whether the hub keeps the last message for those who subscribe later. It is
                published anew after each reconnection, so listeners may hear it again.
            headers: what subscribers that ask for headers are told beside each message, which goes
                before ``callerid`` and ``latching`` of the hub's making. A node has one header for
                each topic: that of its newest publisher which has any.
            peers: whether to ask who subscribes, for `Publisher.peers`.

        Raises:
            ValueError: ``queue_size`` is less than 1, or the headers are no short strings.
        """
        check_queue_size(queue_size)
        header = check_headers(headers) if headers else None
        topic = self.resolve(topic)
        message_class = self._types.message_class(type)
        name = message_class._type
        operation = Advertise(
            id=self._session.id("advertise", topic),
            topic=topic,
            type=name,
            latch=latch,
            queue_size=queue_size,
            definition=self._types.definition(name),
            headers=header,
            peers=peers or None,
        )
        advertisement = self._topics.advertise(operation)
        return Publisher(self._topics, advertisement, self._types.wire(message_class))

    def subscribe(
        self,
        topic: str,
        type: type[M] | str,
        *,
        queue_size: int | None = 10,
        headers: bool = False,
        peers: bool = False,
    ) -> Subscription[M]:
        """Begin to listen to a topic: ``async for message in node.subscribe(...)``.

        If the hub refuses, the reading raises OperationRejected.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            queue_size: how many messages wait for a slow reader; then the newest ones stay. With
                None all wait, and only the hub drops any, if the connection is too slow.
            headers: whether to ask for `Subscription.connection_header`.
            peers: whether to ask who publishes, for `Subscription.peers`.

        Raises:
            ValueError: ``queue_size`` is less than 1.
        """
        if queue_size is not None:
            check_queue_size(queue_size)
        topic = self.resolve(topic)
        message_class = self._types.message_class(type)
        operation = Subscribe(
            id=self._session.id("subscribe", topic),
            topic=topic,
            type=message_class._type,
            queue_length=queue_size or UNBOUNDED_QUEUE,
            headers=headers or None,
            peers=peers or None,
        )
        subscription: Subscription[M] = Subscription(
            operation,
            message_class._type,
            queue_size,
            self._types.wire(message_class).read,
            self._topics.unsubscribe,
            self.log,
        )
        self._topics.subscribe(subscription)
        return subscription

    async def wait_for_message(
        self, topic: str, type: type[M] | str, *, timeout: float | None = None
    ) -> M:
        """Wait for the next message on a topic, on a hub that may not be there yet either.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            timeout: the most seconds to wait; None for ever.

        Raises:
            WaitTimeout: they have passed. It is a TimeoutError, too.
            OperationRejected: the hub refuses.
        """
        check_timeout(timeout)
        return await wait_for_message(self.subscribe(topic, type, queue_size=1), timeout)

    @overload
    async def service(
        self,
        name: str,
        type: type[Service[Req, Res]],
        handler: Handler[Req, Res],
        *,
        headers: Literal[False] = ...,
    ) -> ServiceServer[Req, Res]: ...

    @overload
    async def service(
        self,
        name: str,
        type: type[Service[Req, Res]],
        handler: HeaderHandler[Req, Res],
        *,
        headers: Literal[True],
    ) -> ServiceServer[Req, Res]: ...

    @overload
    async def service(
        self, name: str, type: str, handler: Handler[Any, Any], *, headers: Literal[False] = ...
    ) -> ServiceServer[Any, Any]: ...

    @overload
    async def service(
        self, name: str, type: str, handler: HeaderHandler[Any, Any], *, headers: Literal[True]
    ) -> ServiceServer[Any, Any]: ...

    async def service(
        self,
        name: str,
        type: type[Service[Any, Any]] | str,
        handler: Handler[Any, Any] | HeaderHandler[Any, Any],
        *,
        headers: bool = False,
    ) -> ServiceServer[Any, Any]:
        """Begin to answer the calls of a service.

        Each call is answered in a task of its own, which the end of the service or of the node
        cancels. If the handler raises, the caller is told ``error processing request: ...``, the
        log has the traceback, and the service goes on. A BrokenPipeError ends the node, whose
        `spin` raises it, since nobody reads the program's output any more. If the hub refuses the
        service, the log says so and `ServiceServer.spin` raises OperationRejected.

        Args:
            name: its name.
            type: a service class, or a type's name such as ``"rospy_tutorials/AddTwoInts"``.
            handler: is given the request, and returns the response: whole, or its fields as a dict
                or a tuple, or the value of its only field. It may be async; if it is not, the node
                does nothing else until it returns.
            headers: whether the handler is given the caller's header, too, a dict behind the
                request: ``callerid`` is the caller's node, and what `call` was given as headers is
                beside it. It is empty with hubs of others.

        Raises:
            AlreadyOffered: this node offers the service already. It is a ValueError, too.
            TypeError: the handler is no function.
        """
        service = self._types.service_class(type)
        return self._services.serve(self.resolve(name), service, handler, headers=headers)

    async def call(
        self,
        name: str,
        type: type[Service[Req, Res]] | str,
        request: Req | Mapping[str, Any] | None = None,
        *,
        timeout: float | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Res:
        """Call a service and return its response. Without a hub it waits until there is one.

        Args:
            name: its name.
            type: a service class, or a type's name such as ``"rospy_tutorials/AddTwoInts"``.
            request: a message, or a dict of its fields; None for the type's defaults.
            timeout: seconds after which the caller waits no more; the hub is told them, too. With
                None it is the hub's to give up (``--service-timeout``).
            headers: what a provider that asks for headers is told beside the request.

        Raises:
            ValueError: the timeout is not above 0, or the headers are no short strings.
            InvalidMessage: a field of the request does not fit the type.
            TypeError: the request is a message of another class.
            UnknownService: nobody offers the service.
            ServiceError: it failed; the text is its own, or the hub's.
            ServiceTimeout: there was no answer in time. It is a TimeoutError, too.
            ServiceLost: the connection broke before the answer; nobody knows what was done.
        """
        check_timeout(timeout)
        service = self._types.service_class(type)
        return await self._calls.call(
            self.resolve(name), service, request, within=timeout, headers=headers
        )

    async def wait_for_service(self, name: str, *, timeout: float | None = None) -> None:
        """Wait until somebody offers a service, on a hub that may not be there yet either.

        Args:
            name: its name.
            timeout: the most seconds to wait; None for ever.

        Raises:
            WaitTimeout: they have passed. It is a TimeoutError, too.
        """
        check_timeout(timeout)
        await wait_for_service(self.resolve(name), Rosapi(self._calls), self._session, timeout)

    async def action_server(
        self,
        name: str,
        type: type[Action[G, R, F]] | str,
        execute: Execute[G, R, F],
        *,
        over: Over = "topics",
        concurrent: bool | None = None,
    ) -> ActionServer[G, R, F]:
        """Begin to pursue the goals of an action.

        Each goal is pursued in a task of its own, which the end of the server or of the node
        cancels. If ``execute`` raises, the goal is aborted with the error's text, the log has the
        traceback, and the server goes on; a BrokenPipeError ends the node, as with `service`. If
        the hub refuses the server, the log says so and `ActionServer.spin` raises
        OperationRejected.

        Args:
            name: its name.
            type: an action class, or a type's name such as ``"actionlib_tutorials/Fibonacci"``.
            execute: is given a `ServerGoal`, and returns the result. It may be async; if it is not,
                the node does nothing else until it returns.
            over: how goals come: by the ``"topics"`` of ROS 1's actionlib, or by the
                ``"operations"`` that rosbridge has for ROS 2.
            concurrent: whether goals are pursued side by side; if not, a new goal has the one
                before it canceled, and begins when that has ended. Unless told, it is as in most
                programs of either ROS: not over topics (SimpleActionServer), but over operations.

        Raises:
            ValueError: there is no such way as ``over``.
            AlreadyOffered: this node serves the action already. It is a ValueError, too.
        """
        from fibws.node.actions.over import serve

        action = self._types.action_class(type)
        return serve(self._actions, self.resolve(name), action, execute, over, concurrent)

    def action_client(
        self, name: str, type: type[Action[G, R, F]] | str, *, over: Over = "topics"
    ) -> ActionClient[G, R, F]:
        """Get ready to send goals to an action.

        Args:
            name: its name.
            type: an action class, or a type's name such as ``"actionlib_tutorials/Fibonacci"``.
            over: how goals go, as with `action_server`.

        Raises:
            ValueError: there is no such way as ``over``.
        """
        from fibws.node.actions.over import client

        return client(self._actions, self.resolve(name), self._types.action_class(type), over)

    @cached_property
    def _actions(self) -> Actions:
        from fibws.node.actions.actions import Actions  # Its types take time to load as well.

        async def wait(name: str, within: float | None) -> None:
            await wait_for_service(name, Rosapi(self._calls), self._session, within)

        return Actions(self.name, self._session, self._topics, self._types, wait, time.time_ns)

    def rate(self, hz: float) -> Rate:
        """Ticks for a loop, until the node ends: ``async for _ in node.rate(10)``.

        Raises:
            ValueError: ``hz`` is not a finite number above 0.
        """
        return Rate(hz, self._session.ended)

    async def spin(self) -> None:
        """Wait until the node ends; raise the reason if it was not the program's own doing.

        Once the program has ended the node itself, this returns, and so does every ``async for`` of
        it, while whoever waits for one thing (`wait_for_message`, `call`) has NodeClosed raised.
        """
        await self._session.ended()

    async def __aenter__(self) -> Self:
        if self._session.begun:
            raise RuntimeError("a node is entered once")
        if self._rosout is not None:
            self._rosout.loop = asyncio.get_running_loop()
            self.log.addHandler(self._rosout)
        try:
            await self._connection.open()
        except BaseException:
            self._leave_log()
            raise
        return self

    async def __aexit__(self, *error: object) -> None:
        try:
            await self._connection.close()
        finally:
            self._leave_log()
            await self._session.tasks.finished()

    def _leave_log(self) -> None:
        """Let a logger that outlives the node be."""
        if self._rosout is not None:
            self.log.removeHandler(self._rosout)
