"""The standard actions have a class each, as their definitions say."""

from __future__ import annotations

from fibws.action import action_class
from fibws.action.actionlib_tutorials import Fibonacci
from fibws.interfaces import Action, Interfaces
from fibws.msg import actionlib_tutorials, message_class

INTERFACES = Interfaces()
ACTIONS = [name for package in INTERFACES.packages() for name in INTERFACES.actions(package)]


def test_each_action_has_the_messages_of_its_definition() -> None:
    for name in ACTIONS:
        action = action_class(name)
        assert issubclass(action, Action), name
        assert action._type == name
        assert action.Goal is message_class(f"{name}Goal"), name
        assert action.Result is message_class(f"{name}Result"), name
        assert action.Feedback is message_class(f"{name}Feedback"), name


def test_both_spellings_of_an_action_are_one_class() -> None:
    assert action_class("actionlib_tutorials/action/Fibonacci") is Fibonacci
    assert Fibonacci.Goal(order=5) == actionlib_tutorials.FibonacciGoal(5)
