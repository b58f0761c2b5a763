"""The actions whose goals one client pursues."""

from __future__ import annotations

from fibws.errors import InvalidMessage
from fibws.hub.graph.action import Action, Goal, Ros2GoalStatus, cancel_service
from fibws.hub.session.client import Client, check_room
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    CancelActionGoal,
    Id,
    SendActionGoal,
    UnadvertiseAction,
    encode,
)


class Actions:
    """One client's actions, and the goals that it pursues."""

    __slots__ = ("_client", "_pursued", "_served")

    def __init__(self, client: Client) -> None:
        self._client = client
        self._served: dict[str, tuple[Action, str]] = {}
        """By the action's name, with the spelling of it that the client knows."""
        self._pursued: dict[Id, tuple[Goal, str]] = {}
        """By the ids that the client was given, with its spelling of the action's name."""

    @property
    def node(self) -> str:
        """The name of the client's node."""
        return self._client.node

    def services(self) -> list[str]:
        """The names of the services by which the goals can be cancelled."""
        return [cancel_service(name) for name in self._served]

    def advertise(self, request: AdvertiseAction) -> None:
        """Pursue an action's goals; whoever did before is displaced."""
        name = self._client.resolve(request.action)
        if name not in self._served:
            limit = self._client.settings.max_advertisements
            check_room(len(self._served), limit, "advertisements")
        action = self._client.graph.add_action(name, request.type, request.definition, self)
        self._served[name] = (action, request.action)
        statuses, type_ = self._client.statuses, action.type
        if type_.arguments is None:
            statuses.warning(request.id, f"{name}: goals of type {type_.name} are not checked")
        statuses.info(request.id, f"{self.node} serves {name} ({type_.name})")

    def unadvertise(self, request: UnadvertiseAction) -> None:
        """Pursue an action's goals no more; those that have not ended are aborted."""
        action, _ = self._served.pop(self._client.resolve(request.action), (None, ""))
        if action is not None:
            self._client.graph.remove_action(action)
            for goal, _ in list(self._pursued.values()):
                if goal.action.name == action.name:
                    goal.fail(f"Action {action.name} was unadvertised")

    def pursue(self, goal: Goal) -> None:
        """Have the client begin with a goal."""
        action = goal.action
        _, spelling = self._served[action.name]
        goal.id = f"action_goal:{spelling}:{next(self._client.numbers)}"
        request = SendActionGoal(
            id=goal.id,
            action=spelling,
            action_type=action.type.name,
            args=goal.request,
            feedback=True,
        )
        if self._client.ask(encode(request)):
            self._pursued[goal.id] = (goal, spelling)
        else:
            goal.fail(f"Action {action.name} is unavailable: {self.node} reads too slowly")

    def cancel(self, goal: Goal) -> None:
        """Tell the client that a goal is wanted no more."""
        _, spelling = self._pursued[goal.id]
        self._client.reply(encode(CancelActionGoal(id=goal.id, action=spelling)))

    def forget(self, goal: Goal) -> None:
        """A goal has ended."""
        self._pursued.pop(goal.id, None)

    def displaced(self, action: Action) -> None:
        """Another server has taken an action over; the goals that this one has go on.

        It may be this one, by advertising again.
        """
        if self._client.graph.actions[action.name].server is not self:
            self._served.pop(action.name, None)
            self._client.statuses.warning(None, f"{action.name} has another server now")

    def feedback(self, feedback: ActionFeedback) -> None:
        """Take the client's feedback; raises `InvalidMessage`."""
        goal, _ = self._pursued.get(feedback.id, (None, ""))
        if goal is None:
            self._unknown(feedback)
        else:
            goal.feedback({} if feedback.values is None else feedback.values)

    def result(self, result: ActionResult) -> None:
        """Take a goal's result.

        Raises:
            InvalidMessage: it does not fit the type, as the goal's client was told, too.
        """
        goal, _ = self._pursued.get(result.id, (None, ""))
        if goal is None:
            self._unknown(result)
            return
        status = Ros2GoalStatus(result.status)
        if not result.result:
            reason = result.values
            text = reason if isinstance(reason, str) and reason else "the goal failed"
            canceled = status is Ros2GoalStatus.CANCELED
            goal.fail(text, Ros2GoalStatus.CANCELED if canceled else Ros2GoalStatus.ABORTED)
            return
        try:
            values = {} if result.values is None else result.values
            goal.finish(status or Ros2GoalStatus.SUCCEEDED, values)
        except InvalidMessage as error:
            goal.fail(str(error))
            raise

    def spoil(self, id_: object, text: str) -> None:
        """The client's result of a goal was no operation at all: ``text`` says why."""
        if isinstance(id_, str) and id_ in self._pursued:
            self._pursued[id_][0].fail(text)

    def _unknown(self, operation: ActionFeedback | ActionResult) -> None:
        """The goal may have ended in the meantime."""
        text = f"{operation.op}: no goal of {operation.action} has this id"
        self._client.statuses.info(operation.id, text)

    def leave(self) -> None:
        """Take all back: the goals of others are aborted."""
        for action, _ in self._served.values():
            self._client.graph.remove_action(action)
        self._served.clear()
        for goal, _ in list(self._pursued.values()):
            goal.fail(f"Action {goal.action.name} is unavailable: {self.node} has left")
