"""Waiting for what others do on the graph; the texts of what goes wrong are rospy's."""

from __future__ import annotations

import asyncio
from typing import TypeVar

from fibws.errors import NodeClosed, ServiceLost, WaitTimeout
from fibws.interfaces import Message
from fibws.node.rosapi import Rosapi
from fibws.node.session import Session
from fibws.node.subscription import Subscription

M = TypeVar("M", bound=Message)

FIRST_LOOK = 0.05
LONGEST_LOOK = 0.5
"""Seconds between two looks at the graph, at first and in the end (rospy's: 0.3)."""


async def wait_for_service(name: str, hub: Rosapi, session: Session, within: float | None) -> None:
    """Wait until the graph has a service of this global name; see `Node.wait_for_service`."""
    delay = FIRST_LOOK
    try:
        async with asyncio.timeout(within):
            while not await _exists(name, hub):
                if await session.ended(delay):
                    raise NodeClosed(f"the node ended while waiting for service {name}")
                delay = min(2 * delay, LONGEST_LOOK)
    except TimeoutError:
        raise WaitTimeout(f"timeout exceeded while waiting for service {name}") from None


async def _exists(name: str, hub: Rosapi) -> bool:
    from fibws.srv.rosapi import ServiceType  # It takes 10 ms to load.

    try:
        return bool((await hub.ask("service_type", ServiceType, service=name)).type)
    except ServiceLost:
        return False  # The next question waits until there is a hub again.


async def wait_for_message(subscription: Subscription[M], within: float | None) -> M:
    """Wait for the next message of a subscription and close it; see `Node.wait_for_message`."""
    topic = subscription.topic
    async with subscription:
        try:
            async with asyncio.timeout(within):
                async for message in subscription:
                    return message
        except TimeoutError:
            text = f"timeout exceeded while waiting for message on topic {topic}"
            raise WaitTimeout(text) from None
    raise NodeClosed(f"the node ended while waiting for message on topic {topic}")
