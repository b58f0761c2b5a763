"""The asking end of an action over operations, as rosbridge has them for ROS 2."""

from __future__ import annotations

from typing import Any

from fibws.errors import InvalidMessage, OperationRejected
from fibws.interfaces.message import F, G, R
from fibws.node.actions.client import ActionClient
from fibws.node.actions.client_goal import ClientGoal
from fibws.node.actions.status import GoalStatus, of_ros2
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    CancelActionGoal,
    Reply,
    SendActionGoal,
)
from fibws.protocol.parsing import quoted


class OperationActionClient(ActionClient[G, R, F]):
    """Sends goals for the hub to hand on."""

    def receive(self, reply: Reply) -> bool:
        """Take what is heard of a goal; it may come late, when nobody waits for it any more."""
        if not isinstance(reply, ActionFeedback | ActionResult):
            return False
        goal = self._goals.get(str(reply.id))
        if goal is None:
            return False
        if isinstance(reply, ActionFeedback):
            self._heard(goal, reply.values)
        else:
            self._ended(goal, reply)
        return True

    def refuse(self, id_: str, fault: OperationRejected) -> bool:
        """Fail a goal that the hub does not take."""
        goal = self._goals.get(id_)
        if goal is None:
            return False
        self._fail(goal, GoalStatus.REJECTED, str(fault))
        return True

    async def _served(self) -> None:
        # A service that exists as long as the action does, in ROS 2 as well.
        await self._actions.wait_for_service(f"{self.name}/_action/cancel_goal", None)

    def _heard(self, goal: ClientGoal[R, F], values: Any) -> None:
        try:
            feedback = self._type.feedback.read(values)
        except InvalidMessage as error:
            self._session.log.error("Dropped feedback of %s: %s", self.name, error)
            return
        if goal.status is GoalStatus.PENDING:
            goal.told(GoalStatus.ACTIVE)
        goal.offer(feedback)

    def _ended(self, goal: ClientGoal[R, F], reply: ActionResult) -> None:
        status = of_ros2(reply.status)
        if not reply.result:
            text = reply.values if isinstance(reply.values, str) else quoted(reply.values)
            self._fail(goal, status, text)
            return
        try:
            result = self._type.result.read(reply.values)
        except InvalidMessage as error:
            self._fail(goal, status, f"its result is none of {self.type}: {error}")
            return
        if status is GoalStatus.SUCCEEDED:
            self._succeed(goal, result)
        else:
            self._fail(goal, status, "", result)

    def _new_id(self) -> str:
        return self._session.id("send_action_goal", self.name)

    def _tell_goal(self, id_: str, goal: dict[str, Any]) -> None:
        self._session.say(
            SendActionGoal(
                id=id_, action=self.name, action_type=self.type, args=goal, feedback=True
            )
        )

    def _tell_cancel(self, id_: str) -> None:
        self._session.say(CancelActionGoal(id=id_, action=self.name))

    def _unadvertise(self) -> None:
        """Nothing is registered."""
