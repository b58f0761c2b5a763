"""The error tree."""

from __future__ import annotations

import re
from types import ModuleType

import pytest

from fibws import errors
from fibws.command_names import SETUP
from fibws.errors import (
    DefinitionError,
    FibwsError,
    HubUnreachable,
    InvalidName,
    InvalidTypeName,
    NoHub,
    UnknownPackage,
    UnknownType,
)
from fibws.hub import errors as hub_errors
from fibws.hub.errors import TypeConflict
from fibws.ros1 import errors as ros1_errors
from fibws.tf import errors as tf_errors


def tree(parent: type[FibwsError], depth: int = 0) -> list[tuple[int, str]]:
    """Return the names of the classes below a class, each with its depth."""
    children = [child for child in parent.__subclasses__() if child.__module__ == errors.__name__]
    return [
        (depth, parent.__name__),
        *(line for child in children for line in tree(child, depth + 1)),
    ]


def test_docstring_has_all_classes() -> None:
    assert errors.__doc__ is not None
    lines = re.findall(r"^([│├└─ ]*)([A-Z]\w+)(?:  .*)?$", errors.__doc__, re.MULTILINE)
    assert [(len(indent) // 4, name) for indent, name in lines] == tree(FibwsError)


@pytest.mark.parametrize("module", [hub_errors, ros1_errors, tf_errors])
def test_docstring_of_a_part_has_its_classes(module: ModuleType) -> None:
    own = {each for each in vars(module).values() if isinstance(each, type)}
    names = {each.__name__ for each in own if each.__module__ == module.__name__}
    assert module.__doc__ is not None
    assert names <= set(re.findall(r"^[│├└─ ]*([A-Z]\w+)", module.__doc__, re.MULTILINE))


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (InvalidName("a b", "it has a space"), "'a b' is not a legal name: it has a space"),
        (
            DefinitionError("Int.msg", 3, " int33 x\n", "unknown type"),
            "Int.msg, line 3: unknown type: 'int33 x'",
        ),
        (InvalidTypeName("String"), "String is not a valid type string"),
        (
            UnknownType("msg", "std_msgs", "Sting", "std_msgs/String"),
            "Unable to import msg class Sting from package std_msgs. "
            "Caused by: no such msg in std_msgs; did you mean std_msgs/String?",
        ),
        (
            UnknownType("srv", "std_srvs", "Qwertz", None),
            "Unable to import srv class Qwertz from package std_srvs. "
            "Caused by: no such srv in std_srvs",
        ),
        (
            UnknownType("srv", "std_msgs", "String", None, "msg"),
            "Unable to import srv class String from package std_msgs. "
            "Caused by: no such srv in std_msgs; std_msgs/String is a message",
        ),
        (
            UnknownPackage("my_msgs"),
            "Unable to load the manifest for package my_msgs. "
            "Caused by: no folder of definitions contains it (FIBWS_INTERFACES names them)",
        ),
        (
            TypeConflict("/a", "std_msgs/Int32", "std_msgs/String", "/talker"),
            "Tried to register topic /a with type std_msgs/Int32 "
            "but it is already established with type std_msgs/String (by /talker)",
        ),
        (
            HubUnreachable("ws://localhost:9090", "refused"),
            "The hub at ws://localhost:9090 cannot be reached: refused",
        ),
    ],
)
def test_text_of_an_error(error: FibwsError, text: str) -> None:
    assert str(error) == text


def test_missing_hub_suggests_roscore_in_a_shell_that_has_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    error = NoHub("ws://127.0.0.1:9090", "refused")
    monkeypatch.delenv(SETUP, raising=False)
    assert str(error) == "No hub at ws://127.0.0.1:9090 (refused). Start one with: fibws hub"
    monkeypatch.setenv(SETUP, "{}")
    assert str(error) == "No hub at ws://127.0.0.1:9090 (refused). Start one with: roscore"
