"""Calls and goals between hubs: to servers of other hubs, and from their clients to ours."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from fibws.errors import FibwsError, InvalidMessage
from fibws.hub.delivery.clock import Clock
from fibws.hub.errors import CallFailed, UnknownDefinition
from fibws.hub.federation.backplane import Cancel, OnReply, Peer
from fibws.hub.federation.records import ActionRecord, Kind, Reply, Request, ServiceRecord, failure
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus
from fibws.hub.graph.body import Body
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.service import ANY_MD5SUM, Call, Service
from fibws.interfaces import full_text
from fibws.interfaces.folders import Kind as TypeKind
from fibws.interfaces.serialized_values import SerializedValues

logger = logging.getLogger("fibws.hub")

MOST_REQUESTS = 1000
"""Requests of one hub that may wait for their last reply."""


class RemoteServer:
    """Serves a service of another hub; a `ServiceServer`."""

    def __init__(self, peer: Peer, name: str, node: str) -> None:
        self.node = node
        self._peer = peer
        self._name = name
        self._open: dict[Call, Cancel] = {}

    def handle(self, call: Call) -> None:
        """Pass a call to the hub of the service."""
        peer, type_ = self._peer, call.service.type
        if type_.codecs is None:
            error = UnknownDefinition(type_.name, type_.fault)
            call.fail(str(error), error.code)
            return
        view = peer.backplane.view
        fields = {
            "service": view.outward(self._name),
            "caller": view.node_outward(call.caller),
            "md5sum": type_.md5sum or ANY_MD5SUM,
        }
        body = call.request.ros1()

        def reply(found: Reply) -> None:
            if self._open.pop(call, None) is None:
                return
            if "error" in found.fields:
                call.fail(*_error(found))
                return
            try:
                call.respond(SerializedValues(bytes(found.body)))
            except FibwsError as error:
                call.fail(f"Service {self._name} returned an invalid response: {error}")

        self._open[call] = _nothing
        cancel = peer.backplane.request(peer, Request("call", fields, body), reply)
        if call in self._open:
            self._open[call] = cancel

    def cancel(self, call: Call) -> None:
        """Forget a call, which needs no response any more."""
        cancel = self._open.pop(call, None)
        if cancel is not None:
            cancel()

    def displaced(self, service: Service) -> None:
        """Do nothing: calls that wait may still be answered."""


class RemoteActionServer:
    """Serves an action of another hub; an `ActionServer`."""

    def __init__(self, peer: Peer, name: str, node: str) -> None:
        self.node = node
        self._peer = peer
        self._name = name
        self._open: dict[Goal, Cancel] = {}

    def execute(self, goal: Goal) -> None:
        """Pass a goal to the hub of the action."""
        peer, type_ = self._peer, goal.action.type
        if type_.codecs is None:
            error = UnknownDefinition(type_.name, type_.fault)
            goal.fail(str(error), error.code)
            return
        view = peer.backplane.view
        fields = {
            "action": view.outward(self._name),
            "caller": view.node_outward(goal.caller),
            "type": type_.name,
            "goal": goal.uuid.hex(),
        }

        def reply(found: Reply) -> None:
            if goal not in self._open:
                return
            try:
                if "error" in found.fields:
                    goal.fail(*_error(found))
                elif found.is_final:
                    status = Ros2GoalStatus(found.fields["status"])
                    goal.finish(status, SerializedValues(bytes(found.body)))
                else:
                    goal.feedback(SerializedValues(bytes(found.body)))
            except (FibwsError, KeyError, ValueError) as error:
                goal.fail(f"Action {self._name} returned an invalid reply: {error}")

        self._open[goal] = _nothing
        request = Request("goal", fields, goal.request.ros1())
        cancel = peer.backplane.request(peer, request, reply)
        if goal in self._open:
            self._open[goal] = cancel

    def cancel(self, goal: Goal) -> None:
        """Ask the server to stop; the goal still ends with a result."""
        peer = self._peer
        fields = {"goal": goal.uuid.hex()}
        peer.backplane.request(peer, Request("cancel_goal", fields), lambda reply: None)

    def forget(self, goal: Goal) -> None:
        """Forget a goal that has ended."""
        cancel = self._open.pop(goal, None)
        if cancel is not None:
            cancel()

    def displaced(self, action: Action) -> None:
        """Do nothing: its goals end with their results."""


class RemoteCalls:
    """Attaches services and actions of other hubs, and handles the requests of other hubs.

    Args:
        service_timeout: seconds in which a service must answer; 0 for no limit.
    """

    def __init__(self, graph: Graph, clock: Clock, service_timeout: float) -> None:
        self._graph = graph
        self._clock = clock
        self._timeout = service_timeout
        self._open: dict[Peer, int] = {}
        """The requests of each hub that wait for their last reply."""
        self._goals: dict[tuple[Peer, str], Goal] = {}

    def serve(
        self,
        peer: Peer,
        kind: Kind,
        name: str,
        record: ServiceRecord | ActionRecord,
        definition: str | None,
    ) -> Service | Action:
        """Attach a service or an action of another hub; raises as `Graph.serve`."""
        if kind == "services":
            server = RemoteServer(peer, name, record.node)
            return self._graph.serve(name, record.type, definition, server)
        actions = RemoteActionServer(peer, name, record.node)
        return self._graph.serve_action(name, record.type, definition, actions)

    def remove(self, kind: Kind, served: Any) -> None:
        """Remove what `serve` has returned."""
        if kind == "services":
            self._graph.remove_service(served)
        else:
            self._graph.remove_action(served)

    def handle(self, peer: Peer, request: Request, caller: str, reply: OnReply) -> Cancel:
        """Handle a request of another hub.

        Args:
            caller: the node of this graph whose rights it has.
        """
        if self._open.get(peer, 0) >= MOST_REQUESTS and not request.must_arrive:
            text = f"too many requests wait for this hub (limit {MOST_REQUESTS})"
            reply(failure(text, "limit"))
            return _nothing
        open_ = _OpenRequest(self._open, peer, reply)
        try:
            match request.op:
                case "call":
                    return self._call(request, caller, open_)
                case "goal":
                    return self._send_goal(peer, request, caller, open_)
                case "cancel_goal":
                    goal = self._goals.get((peer, str(request.fields.get("goal"))))
                    if goal is not None:
                        goal.cancel()
                    open_.reply(Reply({}))
                case "ping_node" | "kill_node":
                    return self._ask_node(request, caller, open_)
                case "describe":
                    open_.reply(Reply({"text": self._describe(request, caller)}))
                case op:
                    open_.reply(failure(f"unknown request {op[:40]}", "invalid_operation"))
        except FibwsError as error:
            open_.reply(failure(str(error), getattr(error, "code", "server_failed")))
        except Exception:
            logger.exception("A request of hub %s failed.", peer.hub.name)
            open_.reply(failure("the request failed in the hub; see its log", "internal_error"))
        return _nothing

    def lost(self, peer: Peer) -> None:
        """Forget a hub that is not reached any more."""
        self._open.pop(peer, None)

    def _call(self, request: Request, caller: str, open_: _OpenRequest) -> Cancel:
        graph, name = self._graph, str(request.fields.get("service"))
        service = graph.view(caller).service(name)
        if service is None:
            raise CallFailed(f"Service {name} does not exist", "unknown_service")
        type_ = service.type
        if type_.codecs is None:
            raise UnknownDefinition(type_.name, type_.fault)
        headers = {"md5sum": str(request.fields.get("md5sum", ANY_MD5SUM))}

        def succeeded(call: Call, response: Body) -> None:
            try:
                open_.reply(Reply({}, response.ros1()))
            except (FibwsError, ValueError) as error:
                open_.reply(failure(f"{name} returned an invalid response: {error}", "invalid"))

        def failed(call: Call, text: str, code: str) -> None:
            open_.reply(failure(text, code))

        values = SerializedValues(bytes(request.body))
        call = graph.call(name, values, caller, succeeded, failed, headers)
        call.start(self._timeout, self._clock.call_later)
        return open_.cancelled(call.abandon)

    def _send_goal(self, peer: Peer, request: Request, caller: str, open_: _OpenRequest) -> Cancel:
        graph, name = self._graph, str(request.fields.get("action"))
        action = graph.view(caller).action(name)
        if action is None:
            raise CallFailed(f"Action {name} does not exist", "unknown_action")
        type_ = action.type
        if type_.codecs is None:
            raise UnknownDefinition(type_.name, type_.fault)
        wanted = str(request.fields.get("type", type_.name))
        values = SerializedValues(bytes(request.body))
        goal = graph.send_goal(name, wanted, values, _GoalClient(open_), caller)
        key = peer, str(request.fields.get("goal"))
        self._goals[key] = goal
        open_.on_done = lambda: self._goals.pop(key, None)
        goal.start()
        return open_.cancelled(goal.abandon)

    def _ask_node(self, request: Request, caller: str, open_: _OpenRequest) -> Cancel:
        """Ping or kill a node of this hub, or of one behind it, as a client of it would."""

        def succeeded(call: Call, response: Body) -> None:
            answer = response.values()
            is_fine = bool(answer["success"])
            open_.reply(Reply({}) if is_fine else failure(str(answer["message"]), "node"))

        def failed(call: Call, text: str, code: str) -> None:
            open_.reply(failure(text, code))

        values = {"node": str(request.fields.get("node"))}
        call = self._graph.call(f"/rosapi/{request.op}", values, caller, succeeded, failed)
        call.start(self._timeout, self._clock.call_later)
        return open_.cancelled(call.abandon)

    def _describe(self, request: Request, caller: str) -> str:
        """Return the full text of a type; raise `InterfaceError` if it is unknown."""
        kind, type_ = str(request.fields.get("kind")), str(request.fields.get("type"))
        kinds: dict[str, TypeKind] = {"msg": "msg", "srv": "srv", "action": "action"}
        if kind not in kinds:
            raise InvalidMessage(f"kind must be msg, srv or action, got {kind[:40]}")
        known = self._graph.definitions.known_to(caller, kinds[kind], type_)
        if kind == "msg":
            return known.full_text(type_)
        if kind == "srv":
            return full_text.write_service(known.service(type_), known.message)
        return full_text.write_action(known.action(type_), known.message)


class _OpenRequest:
    """A request of another hub that waits for its last reply."""

    def __init__(self, counts: dict[Peer, int], peer: Peer, reply: OnReply) -> None:
        self._counts = counts
        self._peer = peer
        self._reply = reply
        self.is_done = False
        self.on_done: Callable[[], object] = _nothing
        counts[peer] = counts.get(peer, 0) + 1

    def reply(self, reply: Reply) -> None:
        """Send a reply, unless the last one was sent."""
        if self.is_done:
            return
        if reply.is_final:
            self._end()
        self._reply(reply)

    def cancelled(self, abandon: Callable[[], object]) -> Cancel:
        """Return a function for when the other hub needs no reply any more."""

        def cancel() -> None:
            if not self.is_done:
                self._end()
                abandon()

        return cancel

    def _end(self) -> None:
        self.is_done = True
        if self._peer in self._counts:
            self._counts[self._peer] -= 1
        self.on_done()


class _GoalClient:
    """Sends a goal's feedback and result to another hub; an `ActionClient`."""

    def __init__(self, open_: _OpenRequest) -> None:
        self._open = open_

    def feedback(self, goal: Goal, feedback: Body) -> None:
        """Send feedback."""
        self._open.reply(Reply({}, feedback.ros1(), is_final=False))

    def result(self, goal: Goal, status: Ros2GoalStatus, result: Body) -> None:
        """Send the result."""
        self._open.reply(Reply({"status": int(status)}, result.ros1()))

    def failed(self, goal: Goal, status: Ros2GoalStatus, text: str, code: str) -> None:
        """Send the error of a goal without a result."""
        self._open.reply(failure(text, code))


def _error(reply: Reply) -> tuple[str, str]:
    return str(reply.fields["error"]), str(reply.fields.get("code", "server_failed"))


def _nothing() -> None:
    """Do nothing."""
