"""Services across both worlds: those of ROS 1 nodes for clients of the hub, and the reverse."""

from __future__ import annotations

import asyncio
import logging
import struct
from collections import deque
from collections.abc import Coroutine, Iterator, Mapping
from contextlib import suppress
from typing import Any, TypeVar

from fibws.errors import FibwsError, InterfaceError, OperationError
from fibws.hub.errors import CallFailed, TcprosError, UnknownDefinition
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import ROSBRIDGE, Graph
from fibws.hub.graph.service import Call, Service
from fibws.hub.log.text import printable
from fibws.hub.ros1.connection import TcprosConnection
from fibws.hub.ros1.definition_search import DefinitionSearch
from fibws.hub.ros1.nodes import Ros1Node, Ros1Nodes
from fibws.hub.ros1.rosrpc import Address, ServiceConnection, ServiceConnections
from fibws.hub.ros1.tcpros import ANY, LENGTH, require
from fibws.hub.ros1.topic_registrations import CLIENT
from fibws.hub.settings import Settings
from fibws.interfaces.serialized_values import SerializedValues

T = TypeVar("T")

logger = logging.getLogger("fibws.hub")

FIRST_RETRY, LONGEST_RETRY = 0.5, 60.0
"""Seconds until a service that did not answer is asked for its type again."""
MOST_PROBES = 16
"""Services that are asked for their types at once."""
SEARCH_INTERVAL = 5.0
"""Seconds until a definition that was not found is looked for again, at the next call."""
MOST_CONNECTIONS = 64
"""Calls of one service that are open at once; others wait."""


class RemoteService:
    """A service of a ROS 1 node, which clients of the hub call; a `ServiceServer`.

    Its type is asked for with a probe, which no service takes for a call.
    """

    def __init__(self, links: ServiceLinks, node: Ros1Node, name: str, address: Address) -> None:
        self._links = links
        self._node = node
        self.name = name
        self.address = address
        self.service: Service
        """The service in the graph, once `ServiceLinks.register` has added it."""
        self._tasks: dict[Call, asyncio.Task[None]] = {}
        self._room = asyncio.Semaphore(MOST_CONNECTIONS)
        self._connections = ServiceConnections(name, address)
        self._learning: asyncio.Task[CallFailed | None] | None = None
        self._watching: asyncio.Task[None] | None = None
        self._fault: CallFailed | None = None
        """Why the definition is missing; used again until `_fault_ends`."""
        self._fault_ends = 0.0

    @property
    def node(self) -> str:
        """The name of its node."""
        return self._node.name

    def watch(self) -> None:
        """Ask for its type until that is known."""
        self._watching = self._links.start(self._watch())

    def handle(self, call: Call) -> None:
        """Pass a call to the node."""
        is_filled = call.service.type.is_known
        task = self._links.start(self._perform(call, call.request, call.headers, is_filled))
        self._tasks[call] = task
        task.add_done_callback(lambda _: self._tasks.pop(call, None))

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""
        task = self._tasks.pop(call, None)
        if task is not None:
            task.cancel()

    def displaced(self, service: Service) -> None:
        """Called when another server has the service; calls that wait may still be answered."""
        self._links.displaced(self)

    def close(self) -> None:
        """Stop asking for the type, and close the connections."""
        if self._watching is not None:
            self._watching.cancel()
        self._connections.close()

    async def _perform(
        self, call: Call, request: Body, headers: Mapping[str, str] | None, is_filled: bool
    ) -> None:
        """Call the service and respond to the caller."""
        try:
            async with self._room:
                if call.service.type.codecs is None and (fault := await self._learn()):
                    raise fault
                body = request if is_filled else call.fill(request.values(), headers)
                response = await self._call(call, body.ros1(), headers or {})
                call.respond(SerializedValues(response))
        except FibwsError as error:
            call.fail(str(error), error.code)
        except Exception:
            logger.exception("A call of %s failed.", self.name)
            call.fail(f"a call of {self.name} failed in the hub; see its log")

    async def _call(self, call: Call, request: bytes, headers: Mapping[str, str]) -> bytes:
        type_ = call.service.type
        assert type_.codecs is not None
        header = {
            **self._links.graph.header(call.caller, headers),
            "service": self.name,
            "md5sum": type_.md5sum or ANY,
            "type": type_.name,
        }
        limit = self._links.settings.max_message_size
        return await self._connections.call(header, request, limit)

    async def _watch(self) -> None:
        delay = FIRST_RETRY
        while True:
            async with self._links.probes:
                fault = await self._learn()
            if fault is None or fault is self._fault:
                return
            if delay == FIRST_RETRY:
                logger.info("%s: %s; the hub tries again.", self.node, fault)
            await asyncio.sleep(delay)
            delay = min(2 * delay, LONGEST_RETRY)

    async def _learn(self) -> CallFailed | None:
        """Learn the type, or return why that failed; all who ask at once share one probe."""
        if self._learning is None or self._learning.done():
            self._learning = self._links.start(self._learn_type())
        return await asyncio.shield(self._learning)

    async def _learn_type(self) -> CallFailed | None:
        loop = asyncio.get_running_loop()
        if self._fault is not None and loop.time() < self._fault_ends:
            return self._fault
        try:
            type_, md5sum = await self._probe()
        except CallFailed as error:
            return error
        try:
            await self._define(type_, md5sum)
        except (InterfaceError, OperationError) as error:
            self._fault = CallFailed(f"service [{self.name}]: {error}", "unknown_definition")
            self._fault_ends = loop.time() + SEARCH_INTERVAL
            logger.warning("%s: %s", self.node, self._fault)
            return self._fault
        self._fault = None
        return None

    async def _probe(self) -> tuple[str, str]:
        """Return the type and its md5; raise `CallFailed` if the service does not tell."""
        header = {"service": self.name, "md5sum": ANY, "callerid": ROSBRIDGE, "probe": "1"}
        connection = await ServiceConnection.open(self.name, self.address, header)
        connection.close()
        type_, md5sum = connection.header.get("type"), connection.header.get("md5sum")
        if not type_ or not md5sum or ANY in (type_, md5sum):
            text = f"service [{self.name}] at {self.address} does not tell its type"
            raise CallFailed(text, "unknown_definition")
        return type_, md5sum

    async def _define(self, type_: str, md5sum: str) -> None:
        """Give the service its type; raise `InterfaceError` if the definition is missing."""
        graph, text = self._links.graph, None
        try:
            known = graph.definitions.known_to(self.service.node, "srv", type_)
            if known.service_md5(type_) != md5sum:
                text = await self._find_definition(type_, md5sum)
        except InterfaceError:
            try:
                text = await self._find_definition(type_, md5sum)
            except InterfaceError:
                # The service has the name of its type at least.
                with suppress(InterfaceError, OperationError):
                    graph.learn_service_type(self.service, type_, None, md5sum)
                raise
        graph.learn_service_type(self.service, type_, text, md5sum)

    async def _find_definition(self, type_: str, md5sum: str) -> str:
        found = await self._links.search.find_soon("srv", type_, md5sum)
        logger.info("%s: %s is defined by %s", self.name, printable(type_), found.path)
        return found.text


class ServedClient:
    """A ROS 1 client of one of the hub's services, whose requests are served one by one.

    It is the `Handler` of the client's connection.

    Args:
        header: the fields that the client has sent.
        caller: the node whose rights it has.
    """

    def __init__(
        self,
        links: ServiceLinks,
        header: Mapping[str, str],
        caller: str,
        connection: TcprosConnection,
    ) -> None:
        self._links = links
        self._header = header
        self._connection = connection
        self._transport = connection.transport
        self._service = header["service"]
        self._caller = caller
        self._md5sum = ""
        self._received = bytearray()
        self._requests: deque[bytes] = deque()
        self._arrived = asyncio.Event()
        self._writable = asyncio.Event()
        self._writable.set()
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Answer the header, and serve requests unless that was all.

        Raises:
            OperationError: the client is refused.
        """
        service = self._find()
        type_ = service.type
        given = self._header["md5sum"]
        if type_.md5sum is None or type_.codecs is None:
            raise UnknownDefinition(type_.name, type_.fault)
        if given not in (ANY, type_.md5sum):
            who, known = self._header["callerid"], type_.md5sum
            text = f"request from [{who}]: md5sums do not match: [{given}] vs. [{known}]"
            raise OperationError(text)
        self._md5sum = type_.md5sum
        fields = {
            "callerid": service.node,
            "md5sum": type_.md5sum,
            "type": type_.name,
            "request_type": f"{type_.name}Request",
            "response_type": f"{type_.name}Response",
            "service": service.name,
        }
        self._connection.answer(fields)
        if self._header.get("probe") == "1":
            self._transport.close()
        else:
            self._task = self._links.start(self._serve())

    @property
    def waiting_bytes(self) -> int:
        """Return 0: what is written is the connection's."""
        return 0

    @property
    def incomplete_bytes(self) -> int:
        """Bytes of requests that wait, or came in part."""
        return len(self._received) + sum(map(len, self._requests))

    def shorten(self, size: int, least: int) -> None:
        """Do nothing: each request has a response."""

    def data_received(self, data: bytes) -> None:
        """Take bytes of requests, each of which waits for those before it."""
        received = self._received
        received += data
        while len(received) >= LENGTH:
            size = int.from_bytes(received[:LENGTH], "little")
            limit = self._links.settings.max_message_size
            if size > limit:
                logger.warning(
                    "%s (%s): a request to %s has %d bytes, limit is %d (--max-message-size)",
                    *(self._connection.peer, printable(self._caller), self._service, size, limit),
                )
                self._connection.abort()
                return
            end = LENGTH + size
            if len(received) < end:
                break
            self._requests.append(bytes(memoryview(received)[LENGTH:end]))
            del received[:end]
            self._arrived.set()
        if len(self._requests) > 1:  # With none waiting, it is noticed when the client leaves.
            self._transport.pause_reading()

    def pause_writing(self) -> None:
        """Stop serving requests: the client does not read the responses."""
        self._writable.clear()

    def resume_writing(self) -> None:
        """Continue."""
        self._writable.set()

    def connection_lost(self) -> None:
        """Abandon the call of a client that has left."""
        if self._task is not None:
            self._task.cancel()

    def _find(self) -> Service:
        """Return the service; raise `OperationError` if the hub does not serve it."""
        graph, name = self._links.graph, self._service
        service = graph.view(self._caller).service(name)
        if service is None or isinstance(service.server, RemoteService):
            raise OperationError(f"[{ROSBRIDGE}] is not a provider of [{name}]")
        return service

    async def _serve(self) -> None:
        is_persistent = self._header.get("persistent", "").lower() in ("1", "true")
        try:
            while True:
                while not self._requests:
                    self._arrived.clear()
                    await self._arrived.wait()
                request = self._requests.popleft()
                if len(self._requests) <= 1:
                    self._transport.resume_reading()
                self._transport.write(await self._respond(request))
                await self._writable.wait()
                if not is_persistent:
                    return
        except OperationError as error:
            logger.info("%s: %s", printable(self._caller), error)
        except Exception:
            logger.exception("%s: a call of %s failed.", printable(self._caller), self._service)
        finally:
            self._transport.close()

    async def _respond(self, request: bytes) -> bytes:
        """Return the answer to a request.

        Raises:
            OperationError: the service has left, or has another type than the client knows.
        """
        type_ = self._find().type
        if type_.md5sum != self._md5sum or type_.codecs is None:
            raise OperationError(f"{self._service} has become a {type_.name}")
        try:
            response = await self._call(SerializedValues(request))
            return _answer(1, response.ros1())
        except FibwsError as error:
            return _answer(0, str(error).encode("utf-8", "replace"))

    async def _call(self, values: SerializedValues) -> Body:
        """Call the service; return the response, or raise `CallFailed`."""
        loop = asyncio.get_running_loop()
        done: asyncio.Future[Body | CallFailed] = loop.create_future()
        call = self._links.graph.call(
            self._service,
            values,
            self._caller,
            lambda call, response: _finish(done, response),
            lambda call, text, code: _finish(done, CallFailed(text, code)),
            dict(self._header),
        )
        call.start(self._links.settings.service_timeout, loop.call_later)
        self._links.calls[call] = None
        try:
            result = await done
            if isinstance(result, CallFailed):
                raise result
            return result
        except asyncio.CancelledError:
            call.abandon()
            raise
        finally:
            del self._links.calls[call]


class ServiceLinks:
    """The services of ROS 1 nodes in the graph, and the graph's services for ROS 1 nodes.

    Args:
        search: finds the definitions of types that the hub does not know.
    """

    def __init__(
        self, graph: Graph, nodes: Ros1Nodes, settings: Settings, search: DefinitionSearch
    ) -> None:
        self.graph = graph
        self.settings = settings
        self.search = search
        self._nodes = nodes
        self.probes = asyncio.Semaphore(MOST_PROBES)
        self._remote: dict[str, RemoteService] = {}
        """The services of ROS 1 nodes by their names."""
        self.calls: dict[Call, None] = {}
        """Calls of ROS 1 clients that wait for a response."""
        self._tasks: set[asyncio.Task[Any]] = set()

    def register(self, node: Ros1Node, service: str, uri: str) -> None:
        """Add a service of a ROS 1 node to the graph; its type is learned soon.

        A service that the node may not provide, or that is the hub's own, stays out of the graph:
        a ROS 1 master refuses no registration.

        Args:
            uri: ``rosrpc://host:port``.
        """
        try:
            address = Address.of(uri)
            older = self._remote.get(service)
            if older is not None and (older.node, older.address) == (node.name, address):
                return
            if older is not None:
                self.forget(older)
            remote = RemoteService(self, node, service, address)
            remote.service = self.graph.serve(service, None, None, remote)
        except (FibwsError, ValueError) as error:
            logger.warning(
                "%s: clients of the hub cannot call its service %s: %s",
                node.name,
                printable(service),
                error,
            )
            return
        self._remote[service] = remote
        remote.watch()

    def unregister(self, node: Ros1Node, service: str) -> None:
        """Remove a service of a ROS 1 node, unless another server has taken it over."""
        remote = self._remote.get(service)
        if remote is not None and remote.node == node.name:
            self.forget(remote)
            self.graph.remove_service(remote.service)

    def accept(self, header: Mapping[str, str], connection: TcprosConnection) -> ServedClient:
        """Serve a ROS 1 client of one of the hub's services; raises `TcprosError`."""
        require(header, "service", "md5sum", "callerid")
        caller = header["callerid"]
        if not self.graph.policy.allows_all and caller not in self._nodes.by_name:
            caller = CLIENT  # It may not use the rights of the hub's other nodes.
        client = ServedClient(self, header, caller, connection)
        try:
            client.start()
        except FibwsError as error:
            raise TcprosError(str(error)) from None
        return client

    def withdraw_forbidden(self) -> Iterator[None]:
        """End, one by one, the calls of ROS 1 clients that their rights do not allow any more."""
        for call in list(self.calls):
            if call in self.calls:
                if not self.graph.rights.allows(call.caller, "call", call.service.name):
                    call.withdraw()
            yield

    def displaced(self, remote: RemoteService) -> None:
        """Called when another server has taken over a service."""
        if self._remote.get(remote.name) is remote:
            self.forget(remote)
            self._nodes.service_displaced(remote.name)

    def forget(self, remote: RemoteService) -> None:
        """Forget a service that another server has taken over, or that is to be removed."""
        remote.close()
        if self._remote.get(remote.name) is remote:
            del self._remote[remote.name]

    def start(self, work: Coroutine[Any, Any, T]) -> asyncio.Task[T]:
        """Run a task until `close`."""
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def close(self) -> None:
        """End all calls and connections."""
        for remote in list(self._remote.values()):
            remote.close()
        tasks = list(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def _finish(done: asyncio.Future[Body | CallFailed], result: Body | CallFailed) -> None:
    if not done.done():
        done.set_result(result)


def _answer(is_ok: int, body: bytes) -> bytes:
    return struct.pack("<BI", is_ok, len(body)) + body
