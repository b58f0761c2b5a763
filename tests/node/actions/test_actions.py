"""Creating action servers and clients."""

from __future__ import annotations

from typing import Any

import pytest

from fibws.action.actionlib_tutorials import Fibonacci
from fibws.node.actions.actions import NodeActions, Over
from fibws.node.actions.operations import OperationActionClient, OperationActionServer
from fibws.node.actions.topics import TopicActionClient, TopicActionServer

from ..conftest import FakeSession, sent_operations


def execute(goal: Any) -> Any:
    raise AssertionError(goal)


@pytest.mark.parametrize(
    ("over", "server", "client"),
    [
        ("topics", TopicActionServer, TopicActionClient),
        ("operations", OperationActionServer, OperationActionClient),
    ],
)
async def test_over_selects_the_kind_of_server_and_client(
    actions: NodeActions, over: Over, server: type, client: type
) -> None:
    assert type(actions.serve("/fibonacci", Fibonacci, execute, over=over)) is server
    assert type(actions.client("/fibonacci", Fibonacci, over=over)) is client


async def test_invalid_over_is_refused(actions: NodeActions, session: FakeSession) -> None:
    smoke: Any = "smoke"
    text = 'over must be "topics" or "operations", got \'smoke\''
    with pytest.raises(ValueError, match=text):
        actions.serve("/fibonacci", Fibonacci, execute, over=smoke)
    with pytest.raises(ValueError, match=text):
        actions.client("/fibonacci", Fibonacci, over=smoke)
    assert sent_operations(session) == []
