"""A node of the ROS graph."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, overload

from typing_extensions import TypeVar

from fibws import hub_address, names
from fibws.credentials import Credentials
from fibws.errors import FibwsError, ParameterError
from fibws.interfaces import Action, Message, Service, Time
from fibws.interfaces.message import F, G, R, Req, Res
from fibws.msg.rosgraph_msgs import Log
from fibws.node.calls import Calls
from fibws.node.checks import check_queue_size, check_timeout, check_types
from fibws.node.clock import CLOCK_QUEUE, NodeClock, Rate
from fibws.node.connection import HubConnection
from fibws.node.log import Console, Loggers, Rosout, node_log
from fibws.node.publisher import P, Publisher
from fibws.node.services import Handler, HeaderHandler, NodeServices, ServiceServer
from fibws.node.session import Registration, Session, choose_message_size, throw
from fibws.node.subscription import Subscription, TakeSerialized, next_message
from fibws.node.topics import NodeTopics
from fibws.node.types import ANY_TYPE, NodeTypes
from fibws.protocol.headers import check_headers
from fibws.public_classes import AsyncContext
from fibws.tls import File, TlsFiles

if TYPE_CHECKING:
    from fibws.node.actions.actions import NodeActions, Over
    from fibws.node.actions.client import ActionClient
    from fibws.node.actions.server import ActionServer, Execute
    from fibws.node.graph import Graph
    from fibws.node.params import Params

M = TypeVar("M", bound=Message, default=Any)

NO_REMAPPING = names.Remapping()


@dataclass(frozen=True, slots=True)
class Identity:
    """A node's global name, the namespace of its relative names, and its remappings."""

    name: str
    namespace: str
    remapping: names.Remapping
    resolve_unmapped: names.Resolve = names.resolve
    """Resolves names and checks them."""

    @classmethod
    def choose(
        cls,
        name: str,
        *,
        anonymous: bool,
        namespace: str | None,
        remapping: names.Remapping,
        resolve: names.Resolve = names.resolve,
    ) -> Self:
        """Return a node's identity by its arguments, the command line and $ROS_NAMESPACE.

        Args:
            name: as the next ones, an argument of `Node`.
            anonymous: another one.
            namespace: another one.
            remapping: another one.
            resolve: `names.resolve`, or `names.resolve_any` if names need not be legal.
        """
        names.check_text(name)
        if resolve is names.resolve or "/" in name:
            names.check_base(name)
        if remapping.node_name is not None:
            name = remapping.node_name
        elif anonymous:
            name = names.anonymous(name, pid=os.getpid(), random=os.urandom(8))
        namespace = names.check_namespace(
            remapping.namespace or namespace or os.environ.get("ROS_NAMESPACE", "/")
        )
        return cls(resolve(name, namespace=namespace), namespace, remapping, resolve)

    def resolve(self, name: str) -> str:
        """Return the global name that ``name`` stands for, remappings included."""
        return self.remapping.apply(
            name, namespace=self.namespace, node=self.name, resolver=self.resolve_unmapped
        )


class Node(AsyncContext):
    """A node of the ROS graph: ``async with fibws.Node("talker") as node``.

    A node is entered once, which waits until the hub answers; `start` does the same, and `close`
    leaves it. Leaving it sends pending messages for up to 0.6 s, and logs a warning with the number
    of those that were not sent. It also cancels the handlers of services and actions; a warning
    names those that have not ended in that time. In between the node reconnects whenever the hub is
    lost, and registers everything again. Messages are serialized (`fibws.v1`) with a fibws hub, and
    JSON with a rosbridge_suite server.

    All names are resolved and remapped as in ROS (http://wiki.ros.org/Names). Besides the errors in
    their docstrings all methods may raise `InvalidName` for an illegal name, `InterfaceError` for
    an unknown type, and `NodeClosed`, or the error that ended the node, after its end. Methods that
    use the hub raise RuntimeError before the node is entered.

    Args:
        name: a name without a namespace; a remapping of ``__name`` overrides it.
        hub: ``ws://host:port``, ``wss://host:port`` or ``host:port``; default $FIBWS_HUB, else this
            machine.
        token: the token for a hub that wants one; default that in the hub's URL
            (``ws://host:port/?token=...``), $FIBWS_TOKEN, or the content of $FIBWS_TOKEN_FILE.
        token_file: a file that holds the token, instead of ``token``. It is read again for each
            connection, and before a JWT in it expires.
        anonymous: add a suffix that makes the name unique.
        namespace: the namespace of relative names; default $ROS_NAMESPACE, else ``/``.
        remapping: the remappings of the command line.
        log_format: the console's line, as in ROSCONSOLE_FORMAT; default that variable, else
            rospy's line, which names the node while the process has several.
        log: a logger to use, with its level and handlers, instead of the node's own, which writes
            to the console.
        rosout: whether log records are published on /rosout.
        ca: a PEM file of certificates to trust besides the system's; default $FIBWS_CA.
        client_cert: a PEM file of the certificate that identifies the node to the hub; default
            $FIBWS_CLIENT_CERT, else none.
        client_key: a PEM file of the certificate's private key; default $FIBWS_CLIENT_KEY, else
            ``client_cert``.
        use_sim_time: whether the time is that of the topic /clock, 0 before its first message, for
            `now`, `rate`, the log, and messages that ask for the time; default whether the hub's
            parameter /use_sim_time was true when the node was entered.
        max_message_size: bytes that one message for this node may have; a larger one is dropped,
            logged, and counted by `Subscription.dropped`. Default $FIBWS_MAX_MESSAGE_SIZE, else 64
            MiB. What the node may send is set at the hub.

    Raises:
        InvalidName: a name is not legal.
        InvalidAddress: the hub's address is invalid.
        AccessError: the token is invalid, or its file cannot be read.
        ValueError: both ``token`` and ``token_file`` are given, or ``max_message_size`` is not a
            positive number.
    """

    _hints: ClassVar = {
        "subscribe": "messages come by: async for message in node.subscribe(topic, type)",
        "call": 'a request is one value, such as a dict: node.call(name, type, {"a": 1})',
        "service": "write service(name, type, handler), whose handler takes the request",
        "action_server": "write action_server(name, type, execute), whose execute takes the goal",
    }
    _other_names: ClassVar = {
        "create_publisher": "await node.advertise(topic, type)",
        "create_subscription": "async for message in node.subscribe(topic, type)",
        "create_service": "await node.service(name, type, handler)",
        "create_client": "await node.call(name, type, request)",
        "create_rate": "async for _ in node.rate(hz)",
        "create_timer": "async for _ in node.rate(hz)",
        "get_logger": "node.log",
        "get_name": "node.name",
        "get_param": "await node.params.get(name)",
        "get_parameter": "await node.params.get(name)",
        "set_param": "await node.params.set(name, value)",
        "declare_parameter": "await node.params.get(name, default)",
        "loginfo": "node.log.info(text)",
        "publish": "await publisher.publish(message), of node.advertise(topic, type)",
        "shutdown": "await node.close()",
        "destroy_node": "await node.close()",
        "spin_once": "await node.spin()",
    }
    _needs_legal_names = True
    """Whether names must be legal in ROS; rospy only warns about others."""

    def __init__(
        self,
        name: str,
        *,
        hub: str | None = None,
        token: str | None = None,
        token_file: str | os.PathLike[str] | None = None,
        anonymous: bool = False,
        namespace: str | None = None,
        remapping: names.Remapping = NO_REMAPPING,
        log_format: str | None = None,
        log: logging.Logger | None = None,
        rosout: bool = True,
        ca: File | None = None,
        client_cert: File | None = None,
        client_key: File | None = None,
        use_sim_time: bool | None = None,
        max_message_size: int | None = None,
    ) -> None:
        check_types(log=(log, logging.Logger), remapping=(remapping, names.Remapping))
        self._identity = Identity.choose(
            name,
            anonymous=anonymous,
            namespace=namespace,
            remapping=remapping,
            resolve=names.resolve if self._needs_legal_names else names.resolve_any,
        )
        environment = os.environ
        self._hub = hub_address.hub_url(hub)
        credentials = Credentials.find(hub, token=token, token_file=token_file)
        self.log = log or node_log(
            self.name, log_format or environment.get("ROSCONSOLE_FORMAT") or None
        )
        """The node's logger: its records go to the console and, once the node is entered, to
        /rosout."""
        self._session = Session(self.log, choose_message_size(max_message_size))
        self._clock = NodeClock(self._session)
        self._use_sim_time = use_sim_time
        self._types = NodeTypes(self._clock.now)
        self._calls = Calls(self._session, self._types)
        self._services = NodeServices(self._session, self._types)
        self._topics = NodeTopics(self._session)
        self._rosout: Rosout | None = None
        if rosout:
            self._rosout = Rosout(self.name, self._topics, self._types.codec(Log), self._clock)
        self._loggers = Loggers(self.log, self._services, self.resolve)
        tls = TlsFiles.choose(ca, client_cert, client_key)
        self._connection = HubConnection(
            self._hub, self.name, self._session, self.log, tls, credentials
        )

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

    @property
    def serialized(self) -> bool:
        """Whether messages are serialized (`fibws.v1`); a rosbridge_suite server has them as JSON.

        It is that of the last connection while there is none, and may be read in any thread.
        """
        return self._session.serialized

    def resolve(self, name: str) -> str:
        """Return the global name that ``name`` stands for, remappings included."""
        return self._identity.resolve(name)

    @cached_property
    def params(self) -> Params:
        """The parameters that all nodes share."""
        from fibws.node.params import Params  # Its types take 10 ms to load, and few nodes use it.

        return Params(self._calls, self.resolve)

    @cached_property
    def graph(self) -> Graph:
        """The graph: nodes, topics and services."""
        from fibws.node.graph import Graph  # As for params.

        return Graph(self._calls, self.resolve)

    def now(self) -> Time:
        """Return the time: the system's, or the simulated time of /clock."""
        return Time.from_nanoseconds(self._clock.now())

    async def advertise(
        self,
        topic: str,
        type: Callable[P, M] | str,
        *,
        queue_size: int = 10,
        latch: bool = False,
        headers: Mapping[str, str] | None = None,
        peers: bool = False,
        wait: bool = True,
    ) -> Publisher[M, P]:
        """Advertise a topic, and return its publisher once the hub has registered it.

        It registers again by itself after a reconnection. If the hub refuses that, it is logged,
        and the next publish raises OperationRejected. Subscribers of another type get no messages;
        other publishers of another type are logged as a warning.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            queue_size: most messages to keep while there is no hub.
            latch: whether the hub keeps the last message for later subscribers. It is published
                again after each reconnection, so subscribers may receive it again.
            headers: strings for the connection header, which overrides the hub's ``callerid`` and
                ``latching``. A node has one header for each topic: that of its newest publisher
                which has any.
            peers: whether to ask for the subscribers, for `Publisher.peers`.
            wait: whether to wait until the hub has registered the publisher; if there is no hub,
                until there is one. Without it a first refusal is reported like a later one.

        Raises:
            ValueError: ``queue_size`` is less than 1, or the headers are not short strings.
            OperationRejected: the hub refuses the publisher.
        """
        check_queue_size(queue_size)
        publisher: Publisher[M, Any] = self._topics.advertise(
            self._used(topic),
            self._types.codec(self._types.message_class(type)),
            queue_size=queue_size,
            latch=latch,
            headers=check_headers(headers) if headers else None,
            peers=peers,
        )
        if wait:
            await self._registered(publisher)
        return publisher

    async def advertise_serialized(
        self,
        topic: str,
        type: str,
        *,
        md5sum: str | None = None,
        definition: str | None = None,
        queue_size: int = 10,
        latch: bool = False,
        headers: Mapping[str, str] | None = None,
        peers: bool = False,
        keep_seq: bool = False,
        wait: bool = True,
    ) -> Publisher[Any, ...]:
        """Advertise a topic whose messages are published as bytes in ROS 1's serialization.

        The type need not be known here. A rosbridge_suite server gets no messages of a type that is
        not. The other arguments, and the errors, are those of `advertise`.

        Args:
            topic: its name.
            type: the type's name.
            md5sum: the md5 of the type; None if it is not known.
            definition: the type's text (genpy's ``_full_text``), for a hub that lacks it.
            keep_seq: whether messages keep their ``header.seq``, which the hub sets otherwise.
        """
        check_queue_size(queue_size)
        publisher: Publisher[Any, ...] = self._topics.advertise(
            self._used(topic),
            self._types.serialized(type, md5sum, definition),
            queue_size=queue_size,
            latch=latch,
            headers=check_headers(headers) if headers else None,
            peers=peers,
            keep_seq=keep_seq,
        )
        if wait:
            await self._registered(publisher)
        return publisher

    def subscribe(
        self,
        topic: str,
        type: type[M] | str,
        *,
        queue_size: int | None = 10,
        headers: bool = False,
        peers: bool = False,
    ) -> Subscription[M]:
        """Subscribe to a topic: ``async for message in node.subscribe(...)``.

        If the hub refuses, the iteration raises OperationRejected. Publishers of another type are
        logged as a warning, and their messages do not come.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``. Messages of
                rospy's AnyMsg are not decoded, and may be of any type.
            queue_size: most messages that wait for a slow reader, the newest ones. With None there
                is no limit here; the hub drops messages if the connection is too slow.
            headers: whether to ask for `Subscription.connection_header`.
            peers: whether to ask for the publishers, for `Subscription.peers`.

        Raises:
            ValueError: ``queue_size`` is less than 1.
        """
        if queue_size is not None:
            check_queue_size(queue_size)
        return self._topics.subscribe(
            self._used(topic),
            self._types.codec(self._types.message_class(type)),
            queue_size=queue_size,
            headers=headers,
            peers=peers,
        )

    def subscribe_serialized(self, topic: str, take: TakeSerialized) -> Subscription[Any]:
        """Subscribe to a topic of any type, and have a function called with its messages' bytes.

        Nothing is decoded. ``async for`` waits for the end of the subscription; it raises
        OperationRejected if the hub refuses it. A rosbridge_suite server sends no bytes.

        Args:
            topic: its name.
            take: is called in the node's loop, while the socket is read; it must not raise.
        """
        if not callable(take):
            raise TypeError(f"take must be a function, got {take!r}")
        return self._topics.subscribe(
            self._used(topic),
            self._types.serialized(ANY_TYPE, None, None),
            queue_size=None,
            headers=True,
            take_serialized=take,
        )

    async def wait_for_message(
        self, topic: str, type: type[M] | str, *, timeout: float | None = None
    ) -> M:
        """Wait for the next message of a topic, and return it; without a hub, wait for that, too.

        Args:
            topic: its name.
            type: a message class, or a type's name such as ``"std_msgs/Int32"``.
            timeout: most seconds to wait; None for no limit.

        Raises:
            WaitTimeout: the time is over (a TimeoutError, too).
            OperationRejected: the hub refused the subscription.
        """
        check_timeout(timeout)
        return await next_message(self.subscribe(topic, type, queue_size=1), timeout)

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
        """Provide a service, and return once the hub has registered it.

        Each call is handled in a task of its own, which the end of the service or of the node
        cancels. If the handler raises, the caller gets the error's class and text
        (``error processing request: KeyError: 'x'``), the traceback is logged, and the service goes
        on. A BrokenPipeError ends the node, and its `spin` raises it: the program's output is no
        longer read. If the hub refuses the service after a reconnection, this is logged and
        `ServiceServer.spin` raises it.

        Args:
            name: its name.
            type: a service class, or a type's name such as ``"rospy_tutorials/AddTwoInts"``.
            handler: takes the request, and returns the response: whole, or its fields as a dict or
                a tuple, or the value of its only field. It may be async; if it is not, it blocks
                the node until it returns.
            headers: whether the handler also takes the caller's header, a dict: ``callerid`` is the
                caller's node, and the headers given to `call` are beside it. It is empty with a
                rosbridge_suite server.

        Raises:
            AlreadyOffered: this node provides the service already (a ValueError, too).
            OperationRejected: the hub refuses the service.
            TypeError: the handler is not callable.
        """
        service = self._types.service_class(type)
        server = self._services.serve(self._used(name), service, handler, headers=headers)
        await self._registered(server)
        return server

    async def call(
        self,
        name: str,
        type: type[Service[Req, Res]] | str,
        request: Req | Mapping[str, Any] | None = None,
        *,
        timeout: float | None = None,
        headers: Mapping[str, str] | None = None,
    ) -> Res:
        """Call a service and return its response; without a hub, wait for that first.

        Args:
            name: its name.
            type: a service class, or a type's name such as ``"rospy_tutorials/AddTwoInts"``.
            request: a message, or a dict of its fields; None for the type's defaults.
            timeout: most seconds to wait, sent to the hub, too. With None the hub's own limit
                applies (``--service-timeout``).
            headers: strings for the header that the service's handler may ask for.

        Raises:
            ValueError: the timeout is not above 0, or the headers are not short strings.
            InvalidMessage: a field of the request does not fit the type.
            TypeError: the request is a message of another class.
            UnknownService: the service does not exist.
            ServiceError: the call failed; the text is the service's, or the hub's.
            ServiceTimeout: there was no response in time (a TimeoutError, too).
            ServiceLost: the connection was lost; the call may have taken place or not.
        """
        check_timeout(timeout)
        service = self._types.service_class(type)
        return await self._calls.call(
            self._used(name), service, request, within=timeout, headers=headers
        )

    async def call_with_header(
        self,
        name: str,
        type: type[Service[Req, Res]] | str,
        request: Req | Mapping[str, Any] | None = None,
        *,
        headers: Mapping[str, str],
        timeout: float | None = None,
    ) -> tuple[Res, dict[str, str]]:
        """Call a service as `call` does; return the response and the server's connection header.

        In the header, ``callerid`` is the server's node. It is empty with a rosbridge_suite server.
        The arguments and the errors are those of `call`.
        """
        check_timeout(timeout)
        service = self._types.service_class(type)
        return await self._calls.call_with_header(
            self._used(name), service, request, timeout, headers
        )

    async def wait_for_service(self, name: str, *, timeout: float | None = None) -> None:
        """Wait until a service exists; without a hub, wait for that, too.

        Args:
            name: its name.
            timeout: most seconds to wait; None for no limit.

        Raises:
            WaitTimeout: the time is over (a TimeoutError, too).
        """
        check_timeout(timeout)
        await self._calls.wait_for_service(self._used(name), timeout)

    async def action_server(
        self,
        name: str,
        type: type[Action[G, R, F]] | str,
        execute: Execute[G, R, F],
        *,
        over: Over = "topics",
        concurrent: bool | None = None,
    ) -> ActionServer[G, R, F]:
        """Provide an action, and return once the hub has registered it.

        Each goal is executed in a task of its own, which the end of the server or of the node
        cancels. If ``execute`` raises, the goal is aborted with the error's class and text, the
        traceback is logged, and the server goes on; a BrokenPipeError ends the node, as with
        `service`. If the hub refuses the server after a reconnection, this is logged and
        `ActionServer.spin` raises it.

        Args:
            name: its name.
            type: an action class, or a type's name such as ``"actionlib_tutorials/Fibonacci"``.
            execute: takes a `ServerGoal`, and returns the result. It may be async; if it is not, it
                blocks the node until it returns.
            over: how goals travel: ``"topics"`` as in ROS 1's actionlib, or ``"operations"`` as
                rosbridge has them for ROS 2.
            concurrent: whether goals are executed at the same time; if not, a new goal cancels the
                current one, and begins when that has ended. The default is that of most programs
                of either ROS: false over topics (SimpleActionServer), true over operations.

        Raises:
            ValueError: ``over`` is neither.
            AlreadyOffered: this node provides the action already (a ValueError, too).
            OperationRejected: the hub refuses the server.
        """
        server = self._actions.serve(
            self._used(name),
            self._types.action_class(type),
            execute,
            over=over,
            concurrent=concurrent,
        )
        await self._registered(server)
        return server

    def action_client(
        self, name: str, type: type[Action[G, R, F]] | str, *, over: Over = "topics"
    ) -> ActionClient[G, R, F]:
        """Return a client of an action, which sends goals to it.

        Args:
            name: its name.
            type: an action class, or a type's name such as ``"actionlib_tutorials/Fibonacci"``.
            over: how goals travel, as in `action_server`.

        Raises:
            ValueError: ``over`` is neither ``"topics"`` nor ``"operations"``.
        """
        return self._actions.client(self._used(name), self._types.action_class(type), over=over)

    @cached_property
    def _actions(self) -> NodeActions:
        from fibws.node.actions.actions import NodeActions  # Takes time to load; few nodes need it.

        return NodeActions(
            self.name,
            self._session,
            self._topics,
            self._types,
            self._calls.wait_for_service,
            self._clock.now,
        )

    def rate(self, hz: float) -> Rate:
        """Return ticks for a loop, until the node ends: ``async for _ in node.rate(10)``.

        Raises:
            ValueError: ``hz`` is not a finite number above 0.
        """
        return Rate(hz, self._clock)

    async def flush(self) -> None:
        """Wait until the hub has handled everything that the node has sent; without a hub, wait.

        Afterwards the hub has the subscriptions that `subscribe` returned, for example.
        """
        await self._calls.round_trip()

    async def spin(self) -> None:
        """Wait until the node ends.

        When the program itself has ended the node, this returns, every ``async for`` ends, and
        pending calls (`wait_for_message`, `call`) raise NodeClosed.

        Raises:
            Exception: the error that ended the node, such as NodeReplaced or NotAuthorized.
        """
        await self._session.ended()

    async def start(self) -> Self:
        """Enter the node without ``async with``, such as in a notebook; return the node itself.

        It stays in the graph until `close`, or until the event loop ends.

        Raises:
            RuntimeError: the node has been entered already.
            HubUnreachable: the hub refuses the node, or its address cannot be used.
            ParameterError: a private parameter of the command line is invalid.
        """
        if self._session.begun:
            raise RuntimeError("a node can be entered only once")
        Console.running.append(self.name)
        if self._rosout is not None:
            self._rosout.loop = asyncio.get_running_loop()
            self.log.addHandler(self._rosout)
        try:
            await self._connection.open()
        except BaseException:
            self._leave_log()
            raise
        try:
            await self._set_parameters()
        except BaseException:
            await self.close()
            raise
        if self._use_sim_time is None:
            self._use_sim_time = self._session.is_simulated
        if self._use_sim_time:
            self._clock.set(0)
            self._session.tasks.start(self._follow_clock(), f"clock of {self.name}")
        return self

    async def close(self) -> None:
        """Leave the graph, as the end of ``async with`` does. Does nothing when called again."""
        began = asyncio.get_running_loop().time()
        try:
            await self._connection.close()
        finally:
            try:
                await self._session.end_of(self._session.tasks, began)
            finally:
                self._leave_log()

    async def __aenter__(self) -> Self:
        return await self.start()

    async def __aexit__(self, *error: object) -> None:
        await self.close()

    async def _set_parameters(self) -> None:
        """Set the private parameters of the command line.

        Raises:
            ParameterError: a value is invalid, or the hub refuses it.
        """
        given = self._identity.remapping.parameters
        if not given:
            return
        import yaml

        for name, text in given.items():
            try:
                await self.params.set(f"~{name}", yaml.safe_load(text))
            except (yaml.YAMLError, TypeError, ValueError) as error:
                raise ParameterError(f"_{name}:={text}: {error}") from None

    async def _follow_clock(self) -> None:
        """Set the simulated time by /clock."""
        try:
            clock = self.subscribe("/clock", "rosgraph_msgs/Clock", queue_size=CLOCK_QUEUE)
            async with clock as messages:
                # In the order in which the hub sent it among all messages.
                messages._hand_to(lambda message: self._clock.set(message.clock.to_nanoseconds()))
                async for _ in messages:
                    pass
        except FibwsError as error:
            self.log.error("The time stands still: cannot subscribe to /clock: %s", error)

    def _used(self, name: str) -> str:
        """Return the global name of a topic, service, action or parameter of the node.

        Raises:
            RuntimeError: the node has not been entered: nothing would ever happen.
        """
        self._session.check_entered()
        return self.resolve(name)

    async def _registered(self, registration: Registration) -> None:
        """Wait until the hub knows a registration; take it back if that fails."""
        registration._is_awaited = True
        try:
            await self._calls.round_trip()
            if registration.fault is not None:
                throw(registration.fault)
        except BaseException:
            registration.close()
            raise
        finally:
            registration._is_awaited = False

    def _leave_log(self) -> None:
        """Remove the node's handler from its logger, which may outlive it."""
        if self.name in Console.running:
            Console.running.remove(self.name)
        if self._rosout is not None:
            self.log.removeHandler(self._rosout)
