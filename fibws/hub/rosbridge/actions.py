"""The goals that one client sends, and the actions that it serves."""

from __future__ import annotations

from collections import deque
from typing import Any, NamedTuple

from fibws.errors import FibwsError, InvalidMessage, NotSerialized, OperationError
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus, cancel_service
from fibws.hub.graph.body import Body
from fibws.hub.rosbridge.client import RosbridgeClient, check_room
from fibws.hub.websocket.endpoint import Removals, Work
from fibws.interfaces.serialized_values import SerializedValues
from fibws.protocol.frame_queue import Lane
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    CancelActionGoal,
    Id,
    SendActionGoal,
    UnadvertiseAction,
    encode,
    encode_fields,
    json_of,
    legal_id,
)
from fibws.protocol.serialized import ROS1

MOST_ENDED = 100
"""Goals of a client whose ids are known after their ends."""


class SentGoal(NamedTuple):
    """A goal until its end, without its arguments, which may be large.

    ``lane`` is that of the feedback in the client's send queue; ``serialized`` is true if the goal
    came as bytes, and so feedback and result are to.
    """

    request: SendActionGoal
    lane: Lane
    serialized: bool


class RosbridgeGoals:
    """One client's goals until they end; each goal ends with a result.

    It is an `ActionClient`.
    """

    __slots__ = ("_by_id", "_client", "_ended", "_sent")

    def __init__(self, client: RosbridgeClient) -> None:
        self._client = client
        self._sent: dict[Goal, SentGoal] = {}
        self._by_id: dict[Id, Goal] = {}
        """By the ids that the client gave."""
        self._ended: deque[int] = deque(maxlen=MOST_ENDED)
        """The hashes of the ids of the goals that ended last: ids may be long."""

    def send(self, request: SendActionGoal) -> None:
        """Send a goal.

        Raises:
            OperationError: another goal has its id, so that their results would be ambiguous.
        """
        if request.id in self._by_id:
            raise OperationError(f"A goal of id {request.id} has not ended yet")
        client = self._client
        try:
            check_room(len(self._sent), client.settings.max_goals, "goals")
            name = client.resolve(request.action)
            goal = client.graph.send_goal(
                name, request.action_type, request.args, self, client.node
            )
        except FibwsError as error:
            if request.id is not None:
                self._ended.append(hash(request.id))
            self._fail(request, Ros2GoalStatus.ABORTED, str(error), error.code)
            return
        serialized = isinstance(request.args, SerializedValues)
        request = request.model_copy(update={"args": None})
        self._sent[goal] = SentGoal(request, Lane(client.settings.queue_length), serialized)
        if request.id is not None:
            self._by_id[request.id] = goal
        try:
            goal.start()
        except Exception:
            goal.abandon()
            self._pop(goal)
            raise

    def refuse(self, fields: dict[str, Any], text: str, code: str) -> None:
        """Respond with an error to a malformed send_action_goal: its client may wait all the same.

        Args:
            fields: of the operation.
        """
        action, id_ = fields.get("action"), legal_id(fields.get("id"))
        if isinstance(action, str) and id_ is not None and id_ not in self._by_id:
            request = SendActionGoal(id=id_, action=action, action_type="")
            self._fail(request, Ros2GoalStatus.ABORTED, text, code)

    def cancel(self, request: CancelActionGoal) -> None:
        """Cancel a goal; its result still comes.

        Raises:
            OperationError: the client has sent no goal of this id.
        """
        goal = self._by_id.get(request.id)
        if goal is not None:
            goal.cancel()
            return
        text = f"no goal of {request.action} has this id"
        if hash(request.id) not in self._ended:
            raise OperationError(text)
        # The result was on its way.
        self._client.statuses.info(request.id, f"cancel_action_goal: {text}")

    def feedback(self, goal: Goal, feedback: Body) -> None:
        """Send the client feedback, if it wants any."""
        sent = self._sent[goal]
        if not sent.request.feedback:
            return
        try:
            frames = self._frames(sent, {"op": "action_feedback"}, feedback)
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            text = f"action_feedback: {error}"
            self._client.statuses.error(sent.request.id, text, code=error.code)
        else:
            self._client.queue.put(frames, sent.lane)

    def result(self, goal: Goal, status: Ros2GoalStatus, result: Body) -> None:
        """Send the client a goal's end with its result."""
        sent = self._pop(goal)
        fields = {"op": "action_result", "status": int(status), "result": True}
        try:
            frames = self._frames(sent, fields, result)
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            self._fail(sent.request, Ros2GoalStatus.ABORTED, str(error), error.code)
        else:
            self._client.queue.reply(frames)

    def failed(self, goal: Goal, status: Ros2GoalStatus, text: str, code: str) -> None:
        """Send the client a goal's end without a result."""
        self._fail(self._pop(goal).request, status, text, code)

    def withdraw_forbidden(self) -> Work:
        """Cancel, one by one, the goals that the client's rights do not allow any more."""
        client = self._client
        for goal in list(self._sent):
            is_allowed = client.graph.rights.allows(client.node, "call", goal.action.name)
            if goal in self._sent and not is_allowed:
                goal.withdraw()
            yield

    def leave(self) -> Removals:
        """Wait for no result any more, and return the goals that are to be cancelled."""
        return ((self._abandon, list(self._sent)),)

    def _abandon(self, goal: Goal) -> None:
        if goal in self._sent:  # It may have ended meanwhile.
            goal.abandon()
            self._pop(goal)

    def _pop(self, goal: Goal) -> SentGoal:
        sent = self._sent.pop(goal)
        self._client.queue.forget(sent.lane)
        if self._by_id.pop(sent.request.id, None) is not None:
            self._ended.append(hash(sent.request.id))
        return sent

    def _frames(self, sent: SentGoal, fields: dict[str, Any], body: Body) -> bytes:
        request = sent.request
        return self._client.body_frames(
            {**fields, "action": request.action, "id": request.id},
            body,
            serialized=sent.serialized,
            fragment_size=request.fragment_size,
        )

    def _fail(self, request: SendActionGoal, status: Ros2GoalStatus, text: str, code: str) -> None:
        fields = {
            "op": "action_result",
            "status": int(status),
            "result": False,
            "code": self._client.code(code),
            "action": request.action,
            "id": request.id,
        }
        self._client.reply(encode_fields(fields, values=json_of(text)), request.fragment_size)


class ServedAction(NamedTuple):
    """One of the client's actions, as it advertised it.

    ``spelling`` is its name as the client knows it. Goals are serialized if the type has the
    ``md5sum``.
    """

    action: Action
    spelling: str
    md5sum: str | None


class RosbridgeActions:
    """One client's actions, and the goals that it executes; an `ActionServer`."""

    __slots__ = ("_client", "_goals", "_goals_of", "_served")

    def __init__(self, client: RosbridgeClient) -> None:
        self._client = client
        self._served: dict[str, ServedAction] = {}
        """By the action's name."""
        self._goals: dict[Id, tuple[Goal, str]] = {}
        """By the ids that the client was given, with its spelling of the action's name."""
        self._goals_of: dict[str, dict[Id, Goal]] = {}
        """The same by the actions' names."""

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    def services(self) -> list[str]:
        """Return the names of the services that cancel the goals."""
        return [cancel_service(name) for name in self._served]

    def advertise(self, request: AdvertiseAction) -> None:
        """Serve an action; an older server is displaced."""
        name = self._client.resolve(request.action)
        if name not in self._served:
            self._client.check_room("advertisements", len(self._served))
        action = self._client.graph.serve_action(name, request.type, request.definition, self)
        is_serialized = self._client.serialized and request.compression == ROS1
        md5sum = request.md5sum if is_serialized else None
        self._served[name] = ServedAction(action, request.action, md5sum)
        statuses, type_ = self._client.statuses, action.type
        if type_.arguments is None:
            text = f"{name}: goals of type {type_.name} are not checked"
            statuses.unchecked(request.id, text, type_)
        self._client.check_legal(request.id, request.action, name)
        statuses.info(request.id, f"{self.node} serves {name} ({type_.name})")

    def unadvertise(self, request: UnadvertiseAction) -> Work | None:
        """Stop serving an action; return the steps that abort goals that have not ended."""
        name = self._client.resolve(request.action)
        return self._remove(name) if name in self._served else None

    def _remove(self, name: str) -> Work:
        served = self._served.pop(name, None)
        if served is not None:
            self._client.graph.remove_action(served.action)
        return self._abort(name)

    def _abort(self, name: str) -> Work:
        for goal in list(self._goals_of.get(name, {}).values()):
            goal.fail(f"Action {name} was unadvertised", "server_lost")
            yield

    def withdraw_forbidden(self) -> Work:
        """Take back, one by one, the actions that the client's rights do not allow any more.

        Another server may have displaced the client; the goals that it still has are aborted, too,
        and the client is asked to stop executing them.
        """
        for name in dict.fromkeys((*self._served, *self._goals_of)):
            if not self._client.graph.rights.allows(self.node, "provide", name):
                for goal in list(self._goals_of.get(name, {}).values()):
                    if goal.id in self._goals:
                        goal.cancel()
                    yield
                yield from self._remove(name)
                self._client.report_withdrawn("provide", name)
            yield

    def execute(self, goal: Goal) -> None:
        """Pass a goal to the client."""
        action = goal.action
        _, spelling, md5sum = self._served[action.name]
        goal.id = f"action_goal:{spelling}:{next(self._client.numbers)}"
        fields = {
            "op": "send_action_goal",
            "id": goal.id,
            "action": spelling,
            "action_type": action.type.name,
            "feedback": True,
        }
        serialized = md5sum is not None and md5sum == action.type.md5sum
        try:
            frame = self._client.body_frames(fields, goal.request, serialized=serialized)
        except FibwsError as error:  # It came as bytes that are too much for JSON.
            goal.fail(str(error), error.code)
            return
        if self._client.forward_request(frame):
            self._goals[goal.id] = (goal, spelling)
            self._goals_of.setdefault(action.name, {})[goal.id] = goal
        else:
            text = f"Action {action.name} is unavailable: {self.node} reads too slowly"
            goal.fail(text, "server_busy")

    def cancel(self, goal: Goal) -> None:
        """Ask the client to stop executing a goal."""
        _, spelling = self._goals[goal.id]
        self._client.reply(encode(CancelActionGoal(id=goal.id, action=spelling)))

    def forget(self, goal: Goal) -> None:
        """Forget a goal that has ended."""
        if self._goals.pop(goal.id, None) is not None:
            goals = self._goals_of[goal.action.name]
            del goals[goal.id]
            if not goals:
                del self._goals_of[goal.action.name]

    def displaced(self, action: Action) -> None:
        """Record that another server has an action; goals of this one continue.

        It may be this one, by advertising again.
        """
        newer = self._client.graph.actions[action.name]
        if newer.server is not self:
            self._served.pop(action.name, None)
            self._client.statuses.displaced(action.name, newer.node)

    def feedback(self, feedback: ActionFeedback) -> None:
        """Take the client's feedback; raises `InvalidMessage` and `NotSerialized`."""
        goal, _ = self._goals.get(feedback.id, (None, ""))
        if goal is None:
            self._report_unknown(feedback)
        else:
            goal.feedback({} if feedback.values is None else feedback.values)

    def result(self, result: ActionResult) -> None:
        """Take a goal's result.

        Raises:
            InvalidMessage, NotSerialized: it does not fit the type; the goal's client gets the
                error, too.
        """
        goal, _ = self._goals.get(result.id, (None, ""))
        if goal is None:
            self._report_unknown(result)
            return
        status = Ros2GoalStatus(result.status)
        if not result.result:
            reason = result.values
            text = reason if isinstance(reason, str) and reason else "the goal failed"
            canceled = status is Ros2GoalStatus.CANCELED
            goal.fail(text, status=Ros2GoalStatus.CANCELED if canceled else Ros2GoalStatus.ABORTED)
            return
        try:
            values = {} if result.values is None else result.values
            goal.finish(status or Ros2GoalStatus.SUCCEEDED, values)
        except (InvalidMessage, NotSerialized) as error:
            goal.fail(str(error), error.code)
            raise

    def fail_malformed_result(self, id_: object, text: str, code: str) -> None:
        """Fail the goal whose action_result was malformed."""
        if isinstance(id_, str) and id_ in self._goals:
            self._goals[id_][0].fail(text, code)

    def leave(self) -> Removals:
        """Serve nothing any more, and return the actions to remove and the goals that fail."""
        graph = self._client.graph
        actions = [served.action for served in self._served.values()]
        self._served.clear()
        graph.abandon(actions)
        return (graph.remove_action, actions), (self._lose, list(self._goals))

    def _lose(self, id_: Id) -> None:
        goal, _ = self._goals.get(id_, (None, ""))
        if goal is not None:
            text = f"Action {goal.action.name} is unavailable: {self.node} has left"
            goal.fail(text, "server_lost")

    def _report_unknown(self, operation: ActionFeedback | ActionResult) -> None:
        # The goal may have ended in the meantime.
        text = f"{operation.op}: no goal of {operation.action} has this id"
        self._client.statuses.info(operation.id, text)
