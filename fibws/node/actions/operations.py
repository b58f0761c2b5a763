"""Actions over rosbridge's operations, which it has for ROS 2.

The hub routes goals to the server, and feedback and results back to the goal's client.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Iterator
from typing import Any

from fibws.errors import InvalidMessage, MessageTooLarge, NotSerialized, OperationRejected
from fibws.interfaces.message import F, G, R
from fibws.interfaces.serialized_values import SerializedValues
from fibws.node.actions.client import ActionClient, ClientGoal
from fibws.node.actions.server import ActionServer, Execute
from fibws.node.actions.status import GoalRecord
from fibws.node.session import Session
from fibws.node.types import MessageCodec, NodeActionType
from fibws.protocol.decoding import quoted
from fibws.protocol.goals import GoalStatus, status_from_ros2
from fibws.protocol.operations import (
    ActionFeedback,
    ActionResult,
    AdvertiseAction,
    CancelActionGoal,
    Operation,
    Reply,
    SendActionGoal,
    UnadvertiseAction,
)
from fibws.protocol.serialized import ROS1


def serialized(
    codec: MessageCodec[Any], values: dict[str, Any], md5sum: str | None = None
) -> SerializedValues:
    """Return JSON values as bytes."""
    return SerializedValues(codec.serialize(codec.read(values)), md5sum)


class OperationActionServer(ActionServer[G, R, F]):
    """Executes the goals that the hub passes on."""

    def __init__(
        self,
        session: Session,
        name: str,
        type_: NodeActionType[G, R, F],
        execute: Execute[G, R, F],
        *,
        concurrent: bool,
    ) -> None:
        super().__init__(session, name, type_, execute, concurrent=concurrent)
        self._operation = AdvertiseAction(
            id=session.id("advertise_action", name),
            action=name,
            type=type_.name,
            definition=type_.definition,
        )
        self._serialized: set[str] = set()
        """The ids of goals that came as bytes, so that feedback and results may be bytes, too."""
        session.send(self._registration())

    # Called by the session

    def _registrations(self) -> Iterator[Operation]:
        """Yield the advertisement."""
        yield self._registration()

    def _on_reply(self, reply: Reply) -> bool:
        """Handle a goal, or a request to cancel one."""
        match reply:
            case SendActionGoal(action=self.name):
                self._on_goal(str(reply.id), reply.args)
                return True
            case CancelActionGoal(action=self.name):
                self._cancel(str(reply.id))
                return True
        return False

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """Close the server if the hub refuses its advertisement."""
        if id_ != self._operation.id:
            return False
        self._refuse(error)
        return True

    def _on_disconnect(self) -> None:
        """Ask all goals to stop, and drop their results: the hub has failed them already."""
        goals = list(self._goals.values())
        self._goals.clear()
        self._serialized.clear()
        self._next = None
        for goal in goals:
            goal._request_cancel()

    def _registration(self) -> AdvertiseAction:
        if not self._session.serialized_values:
            return self._operation
        update = {"compression": ROS1, "md5sum": self._type.md5sum}
        return self._operation.model_copy(update=update)

    def _on_goal(self, id_: str, args: Any) -> None:
        try:
            request = self._type.goal.read(args)
        except InvalidMessage as error:
            self._send_failure(id_, str(error))
        else:
            if isinstance(args, SerializedValues):
                self._serialized.add(id_)
            self._receive(GoalRecord(id_), request)

    def _values(
        self, record: GoalRecord, codec: MessageCodec[Any], values: dict[str, Any]
    ) -> dict[str, Any] | SerializedValues:
        return serialized(codec, values) if record.id in self._serialized else values

    # Called by the base class

    def _send_status(self) -> None:
        """Do nothing: no operation carries a status."""

    def _send_feedback(self, record: GoalRecord, feedback: dict[str, Any]) -> None:
        values = self._values(record, self._type.feedback, feedback)
        self._session.send(ActionFeedback(id=record.id, action=self.name, values=values))

    def _send_result(self, record: GoalRecord, result: dict[str, Any] | None) -> None:
        if result is None or (record.text and record.status is not GoalStatus.SUCCEEDED):
            self._send_failure(record.id, record.text or "the goal was canceled", record.status)
            return
        values = self._values(record, self._type.result, result)
        self._serialized.discard(record.id)
        try:
            self._session.send(
                ActionResult(
                    id=record.id,
                    action=self.name,
                    values=values,
                    status=record.status.ros2,
                    result=True,
                )
            )
        except MessageTooLarge as error:
            self._session.log.error("The result of goal %s is lost: %s", record.id, error)
            self._send_failure(record.id, str(error))

    def _send_failure(self, id_: str, text: str, status: GoalStatus = GoalStatus.ABORTED) -> None:
        self._serialized.discard(id_)
        self._session.send(
            ActionResult(id=id_, action=self.name, values=text, status=status.ros2, result=False)
        )

    def _unadvertise(self) -> None:
        self._session.send(UnadvertiseAction(id=self._operation.id, action=self.name))


class OperationActionClient(ActionClient[G, R, F]):
    """Sends goals that the hub passes on to the server.

    Args:
        wait_for_service: waits for the service of a global name, at most so many seconds.
    """

    def __init__(
        self,
        session: Session,
        name: str,
        type_: NodeActionType[G, R, F],
        wait_for_service: Callable[[str, float | None], Awaitable[None]],
    ) -> None:
        super().__init__(session, name, type_)
        self._wait_for_service = wait_for_service
        self._sent_serialized: dict[str, dict[str, Any]] = {}
        """The JSON values of goals that were sent as bytes, by their ids, until they end."""

    # Called by the session

    def _on_reply(self, reply: Reply) -> bool:
        """Handle feedback or the result of a goal, unless the goal has ended."""
        if not isinstance(reply, ActionFeedback | ActionResult):
            return False
        goal = self._goals.get(str(reply.id))
        if goal is None:
            return False
        if isinstance(reply, ActionFeedback):
            self._on_feedback(goal, reply.values)
        else:
            self._on_result(goal, reply)
        return True

    def _on_refusal(self, id_: str, error: OperationRejected) -> bool:
        """Fail a goal that the hub refuses."""
        goal = self._goals.get(id_)
        if goal is None:
            return False
        self._fail(goal, GoalStatus.REJECTED, str(error))
        return True

    def _on_feedback(self, goal: ClientGoal[R, F], values: Any) -> None:
        try:
            feedback = self._type.feedback.read(values)
        except InvalidMessage as error:
            self._session.log.error("Dropped feedback of %s: %s", self.name, error)
            return
        if goal.status is GoalStatus.PENDING:
            goal._update(GoalStatus.ACTIVE)
        goal._offer(feedback)

    def _on_result(self, goal: ClientGoal[R, F], reply: ActionResult) -> None:
        status = status_from_ros2(reply.status)
        if not reply.result and reply.code == NotSerialized.code:
            values = self._sent_serialized.pop(goal.id, None)
            if values is not None:  # The server has not got it.
                self._send(goal.id, values)
                return
        if not reply.result:
            text = reply.values if isinstance(reply.values, str) else quoted(reply.values)
            self._fail(goal, status, text)
            return
        try:
            result = self._type.result.read(reply.values)
        except InvalidMessage as error:
            self._fail(goal, status, f"invalid result: {error}")
            return
        if status is GoalStatus.SUCCEEDED:
            self._succeed(goal, result)
        else:
            self._fail(goal, status, "", result)

    # Called by the base class

    async def _server_available(self) -> None:
        # This service exists exactly as long as the action does, in ROS 2 as well.
        await self._wait_for_service(f"{self.name}/_action/cancel_goal", None)

    def _new_id(self) -> str:
        return self._session.id("send_action_goal", self.name)

    def _send_goal(self, id_: str, goal: dict[str, Any]) -> None:
        if not self._session.serialized_values:
            self._send(id_, goal)
            return
        self._send(id_, serialized(self._type.goal, goal, self._type.md5sum))
        self._sent_serialized[id_] = goal

    def _send(self, id_: str, args: dict[str, Any] | SerializedValues) -> None:
        self._session.send(
            SendActionGoal(
                id=id_, action=self.name, action_type=self.type, args=args, feedback=True
            )
        )

    def _forget(self, goal: ClientGoal[R, F]) -> None:
        super()._forget(goal)
        self._sent_serialized.pop(goal.id, None)

    def _send_cancel(self, id_: str) -> None:
        self._session.send(CancelActionGoal(id=id_, action=self.name))

    def _unadvertise(self) -> None:
        """Do nothing: a client has no registrations."""
