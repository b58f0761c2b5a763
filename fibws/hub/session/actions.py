"""The actions whose goals one client pursues, and the goals that it has sent."""

from __future__ import annotations

from itertools import count
from typing import Any

from pydantic_core import to_json

from fibws.errors import FibwsError, InvalidMessage, OperationError
from fibws.hub.framing import text_frame
from fibws.hub.graph.action import Action, Goal, GoalStatus
from fibws.hub.graph.encoding import text_frames
from fibws.hub.session.client import Client
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
)


class Actions:
    """One client's part in actions, as server and as client."""

    __slots__ = ("_by_id", "_client", "_numbers", "_pursued", "_sent", "_served")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._served: dict[str, tuple[Action, str]] = {}
        """By the action's name, with the spelling of it that the client knows."""
        self._pursued: dict[Id, Goal] = {}
        """What the client pursues, by the ids that it was given."""
        self._sent: dict[Goal, SendActionGoal] = {}
        """What the client waits for."""
        self._by_id: dict[Id, Goal] = {}
        """What the client waits for, by the ids that it gave."""
        self._numbers = count(1)

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    # As a client.

    def send_goal(self, request: SendActionGoal) -> None:
        """Send a goal; whatever becomes of that, there is a result."""
        try:
            goal = self._goal(request)
        except FibwsError as error:
            self._result(request, GoalStatus.ABORTED, to_json(str(error)), ok=False)
            return
        self._sent[goal] = request
        if request.id is not None:
            self._by_id[request.id] = goal
        goal.start()

    def _goal(self, request: SendActionGoal) -> Goal:
        graph = self._client.graph
        name = self._client.resolve(request.action)
        action = graph.actions.get(name)
        if action is None:
            raise OperationError(f"Action {name} does not exist")
        type_ = graph.interfaces.canonical(request.action_type)
        if type_ != action.type.type:
            raise OperationError(f"Action {name} is of type {action.type.type}, not {type_}")
        if request.id in self._by_id:
            raise OperationError(f"A goal of id {request.id} has not ended yet")
        self._client.check_room(len(self._sent), "max_goals")
        valid = action.type.goal({} if request.args is None else request.args)
        return graph.goal(action, valid, self)

    def cancel_goal(self, request: CancelActionGoal) -> None:
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
        request = self._sent[goal]
        if request.feedback:
            self._reply(request, {"op": "action_feedback"}, feedback)

    def end(self, goal: Goal, status: GoalStatus, result: bytes, *, ok: bool) -> None:
        """Send the client a goal's result."""
        request = self._sent.pop(goal)
        self._by_id.pop(request.id, None)
        self._result(request, status, result, ok=ok)

    def _result(
        self, request: SendActionGoal, status: GoalStatus, values: bytes, *, ok: bool
    ) -> None:
        self._reply(request, {"op": "action_result", "status": int(status), "result": ok}, values)

    def _reply(self, request: SendActionGoal, fields: dict[str, Any], values: bytes) -> None:
        text = encode_fields({**fields, "action": request.action, "id": request.id}, values=values)
        self._client.outbox.reply(text_frames(text, request.fragment_size, self._fragment_id))

    def _fragment_id(self) -> str:
        return f"action:{next(self._numbers)}"

    # As a server.

    def advertise(self, request: AdvertiseAction) -> None:
        """Pursue an action's goals; whoever did before is displaced."""
        name = self._client.resolve(request.action)
        if name not in self._served:
            self._client.check_room(len(self._served), "max_advertisements")
        action = self._client.graph.add_action(name, request.type, request.definition, self)
        self._served[name] = (action, request.action)
        self._client.statuses.info(request.id, f"{self.node} serves {name} ({action.type.type})")

    def unadvertise(self, request: UnadvertiseAction) -> None:
        """Pursue an action's goals no more; those that have not ended are aborted."""
        action, _ = self._served.pop(self._client.resolve(request.action), (None, ""))
        if action is not None:
            self._client.graph.remove_action(action)
            self._abort(action, f"Action {action.name} was unadvertised")

    def pursue(self, goal: Goal) -> None:
        """Have the client begin with a goal."""
        action = goal.action
        _, spelling = self._served[action.name]
        goal.id = f"action_goal:{spelling}:{next(self._numbers)}"
        request = SendActionGoal(
            id=goal.id,
            action=spelling,
            action_type=action.type.type,
            args=goal.request,
            feedback=True,
        )
        text = encode(request)
        if self._client.outbox.has_room(len(text)):
            self._pursued[goal.id] = goal
            self._client.outbox.reply(text_frame(text))
        else:
            # Its replies may not be dropped: it must not be others' goals that break its bounds.
            goal.fail(f"Action {action.name} is unavailable: {self.node} reads too slowly")

    def cancel(self, goal: Goal) -> None:
        """Tell the client that a goal is wanted no more."""
        self._client.send(CancelActionGoal(id=goal.id, action=self._spelling(goal)))

    def forget(self, goal: Goal) -> None:
        """A goal has ended."""
        self._pursued.pop(goal.id, None)

    def displaced(self, action: Action) -> None:
        """Another client has taken an action over; its goals that this one has go on."""
        served = self._served.get(action.name)
        if served is not None and served[0] is action:
            del self._served[action.name]
            self._client.statuses.warning(None, f"{action.name} has another server now")

    def feedback(self, feedback: ActionFeedback) -> None:
        """Take the client's feedback; raises `InvalidMessage`."""
        goal = self._pursued.get(feedback.id)
        if goal is None:
            self._unknown(feedback)
        else:
            goal.feedback({} if feedback.values is None else feedback.values)

    def result(self, result: ActionResult) -> None:
        """Take a goal's result.

        Raises:
            InvalidMessage: it does not fit the type, as the goal's client was told, too.
        """
        goal = self._pursued.get(result.id)
        if goal is None:
            self._unknown(result)
            return
        status = GoalStatus(result.status)
        if not result.result:
            reason = result.values
            text = reason if isinstance(reason, str) and reason else "the goal failed"
            goal.fail(text, status or GoalStatus.ABORTED)
            return
        try:
            values = {} if result.values is None else result.values
            goal.finish(status or GoalStatus.SUCCEEDED, values)
        except InvalidMessage as error:
            goal.fail(str(error))
            raise

    def _unknown(self, operation: ActionFeedback | ActionResult) -> None:
        """The goal may have ended in the meantime."""
        text = f"{operation.op}: no goal of {operation.action} has this id"
        self._client.statuses.info(operation.id, text)

    def _spelling(self, goal: Goal) -> str:
        _, spelling = self._served.get(goal.action.name, (None, goal.action.name))
        return spelling

    def _abort(self, action: Action, text: str) -> None:
        for goal in list(action.goals.values()):
            goal.fail(text)

    def leave(self) -> None:
        """Take all back: the goals of others are aborted, its own cancelled."""
        for action, _ in self._served.values():
            self._client.graph.remove_action(action)
        self._served.clear()
        for goal in list(self._sent):
            goal.abandon()
        self._sent.clear()
        self._by_id.clear()
        for goal in list(self._pursued.values()):
            goal.fail(f"Action {goal.action.name} is unavailable: {self.node} has left")
