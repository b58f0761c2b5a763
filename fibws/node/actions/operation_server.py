"""The serving end of an action over operations, as rosbridge has them for ROS 2."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fibws.errors import InvalidMessage, OperationRejected
from fibws.interfaces.message import F, G, R
from fibws.node.actions.action_type import ActionType
from fibws.node.actions.actions import Actions
from fibws.node.actions.record import Record
from fibws.node.actions.server import ActionServer, Execute
from fibws.node.actions.status import GoalStatus
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    CancelActionGoal,
    Reply,
    SendActionGoal,
    UnadvertiseAction,
    encode,
)


class OperationActionServer(ActionServer[G, R, F]):
    """Takes the goals that the hub hands on."""

    def __init__(
        self,
        actions: Actions,
        name: str,
        type_: ActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
    ) -> None:
        super().__init__(actions, name, type_, execute, concurrent=concurrent)
        self._operation = AdvertiseAction(
            id=self._session.id("advertise_action", name),
            action=name,
            type=type_.name,
            definition=type_.definition,
        )
        self._session.say(self._operation)

    def greeting(self) -> Iterator[bytes]:
        """The registration."""
        yield encode(self._operation)

    def receive(self, reply: Reply) -> bool:
        """Take a goal, or the word that it is wanted no more."""
        match reply:
            case SendActionGoal(action=self.name):
                self._take_goal(str(reply.id), reply.args)
                return True
            case CancelActionGoal(action=self.name):
                self._cancel(str(reply.id))
                return True
        return False

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """The hub does not have this server."""
        if id_ != self._operation.id:
            return False
        self._refuse(fault)
        return True

    def lose(self) -> None:
        """Nobody waits for any goal any more: the hub has told all clients that these failed."""
        goals = list(self._goals.values())
        self._goals.clear()
        self._next = None
        for goal in goals:
            goal.want_no_more()

    def _take_goal(self, id_: str, args: Any) -> None:
        try:
            request = self._type.goal.read(args)
        except InvalidMessage as error:
            self._fail(id_, str(error))
        else:
            self._receive(Record(id_), request)

    def _tell_status(self) -> None:
        """There is no operation for it."""

    def _tell_feedback(self, record: Record, feedback: dict[str, Any]) -> None:
        self._session.say(ActionFeedback(id=record.id, action=self.name, values=feedback))

    def _tell_result(self, record: Record, result: dict[str, Any] | None) -> None:
        if result is None or (record.text and record.status is not GoalStatus.SUCCEEDED):
            self._fail(record.id, record.text or "the goal was canceled", record.status)
            return
        self._session.say(
            ActionResult(
                id=record.id,
                action=self.name,
                values=result,
                status=record.status.ros2,
                result=True,
            )
        )

    def _fail(self, id_: str, text: str, status: GoalStatus = GoalStatus.ABORTED) -> None:
        self._session.say(
            ActionResult(id=id_, action=self.name, values=text, status=status.ros2, result=False)
        )

    def _unadvertise(self) -> None:
        self._session.say(UnadvertiseAction(id=self._operation.id, action=self.name))
