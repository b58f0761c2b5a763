"""The goals that one client has sent."""

from __future__ import annotations

from typing import Any

from fibws.errors import FibwsError, OperationError
from fibws.hub.graph.action import Goal, Ros2GoalStatus
from fibws.hub.outbox import Queue
from fibws.hub.session.client import Client, check_room
from fibws.protocol.operations import (
    CancelActionGoal,
    Id,
    SendActionGoal,
    encode_fields,
    json_of,
    legal_id,
)


class Goals:
    """One client's goals, until they end; whatever becomes of one, there is a result."""

    __slots__ = ("_by_id", "_client", "_sent")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._sent: dict[Goal, tuple[SendActionGoal, Queue]] = {}
        """With the feedback that waits for the client."""
        self._by_id: dict[Id, Goal] = {}
        """By the ids that the client gave."""

    def send(self, request: SendActionGoal) -> None:
        """Send a goal.

        Raises:
            OperationError: another goal has its id, and the client could not tell their results.
        """
        if request.id in self._by_id:
            raise OperationError(f"A goal of id {request.id} has not ended yet")
        try:
            goal = self._goal(request)
        except FibwsError as error:
            self._result(request, Ros2GoalStatus.ABORTED, json_of(str(error)), ok=False)
            return
        # The arguments may be large, and the server has been told them.
        request = request.model_copy(update={"args": None})
        self._sent[goal] = (request, Queue(self._client.settings.queue_length))
        if request.id is not None:
            self._by_id[request.id] = goal
        try:
            goal.start()
        except Exception:
            goal.abandon()
            self._forget(goal)
            raise

    def refuse(self, fields: dict[str, Any], text: str) -> None:
        """What should have been a goal is none: its client may wait for a result all the same."""
        action, id_ = fields.get("action"), legal_id(fields.get("id"))
        if isinstance(action, str) and id_ is not None and id_ not in self._by_id:
            request = SendActionGoal(id=id_, action=action, action_type="")
            self._result(request, Ros2GoalStatus.ABORTED, json_of(text), ok=False)

    def cancel(self, request: CancelActionGoal) -> None:
        """Want a goal no more; its result still comes."""
        goal = self._by_id.get(request.id)
        if goal is None:
            # It may have ended in the meantime.
            text = f"cancel_action_goal: no goal of {request.action} has this id"
            self._client.statuses.info(request.id, text)
        else:
            goal.cancel()

    def hear(self, goal: Goal, feedback: bytes) -> None:
        """Send the client feedback, if it wants any."""
        request, queue = self._sent[goal]
        if request.feedback:
            text = _text(request, {"op": "action_feedback"}, feedback)
            self._client.outbox.put(self._client.frames(text, request.fragment_size), queue)

    def end(self, goal: Goal, status: Ros2GoalStatus, result: bytes, *, ok: bool) -> None:
        """Send the client a goal's result."""
        self._result(self._forget(goal), status, result, ok=ok)

    def leave(self) -> None:
        """Cancel all; nobody waits for a result."""
        for goal, (_, queue) in list(self._sent.items()):
            goal.abandon()
            self._client.outbox.forget(queue)
        self._sent.clear()
        self._by_id.clear()

    def _forget(self, goal: Goal) -> SendActionGoal:
        request, queue = self._sent.pop(goal)
        self._client.outbox.forget(queue)
        self._by_id.pop(request.id, None)
        return request

    def _goal(self, request: SendActionGoal) -> Goal:
        graph = self._client.graph
        name = self._client.resolve(request.action)
        action = graph.actions.get(name)
        if action is None:
            raise OperationError(f"Action {name} does not exist")
        type_ = graph.interfaces.canonical(request.action_type)
        if type_ != action.type.name:
            raise OperationError(f"Action {name} is of type {action.type.name}, not {type_}")
        check_room(len(self._sent), self._client.settings.max_goals, "goals")
        return graph.new_goal(action, action.type.ask(request.args), self)

    def _result(
        self, request: SendActionGoal, status: Ros2GoalStatus, values: bytes, *, ok: bool
    ) -> None:
        fields = {"op": "action_result", "status": int(status), "result": ok}
        self._client.reply(_text(request, fields, values), request.fragment_size)


def _text(request: SendActionGoal, fields: dict[str, Any], values: bytes) -> bytes:
    return encode_fields({**fields, "action": request.action, "id": request.id}, values=values)
