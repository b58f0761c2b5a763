"""Callbacks of filters."""

from __future__ import annotations

from message_filters import SimpleFilter


def test_callbacks_are_called_in_order_with_their_arguments() -> None:
    seen: list[tuple[object, ...]] = []
    source = SimpleFilter()
    assert source.registerCallback(lambda *args: seen.append(args)) == 0
    assert source.registerCallback(lambda *args: seen.append(args), "more", 8) == 1
    source.signalMessage("a", "b")
    assert seen == [("a", "b"), ("a", "b", "more", 8)]


def test_callback_can_register_another() -> None:
    source = SimpleFilter()
    source.registerCallback(lambda message: source.registerCallback(print))
    source.signalMessage("a")
    assert len(source.callbacks) == 2
