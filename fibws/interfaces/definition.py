"""The parsed contents of .msg, .srv and .action files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from fibws.interfaces import builtin

Scalar: TypeAlias = bool | int | float | str


@dataclass(frozen=True, slots=True)
class Array:
    """The number of elements of an array: any, exactly ``size``, or at most ``size``."""

    size: int | None = None
    bounded: bool = False

    @property
    def fixed(self) -> int | None:
        """The number of elements, if the definition fixes it."""
        return None if self.bounded else self.size

    def __str__(self) -> str:
        return f"[{'<=' if self.bounded else ''}{'' if self.size is None else self.size}]"


@dataclass(frozen=True, slots=True)
class Field:
    """One field: ``type`` is a builtin type, or that of another message as ``package/Type``.

    ``limit`` is the most characters a bounded string may have, ``default`` what ROS 2 lets a
    definition give, ``line`` where the file has it.
    """

    name: str
    type: str
    array: Array | None = None
    limit: int | None = None
    default: Scalar | tuple[Scalar, ...] | None = None
    line: int = field(default=0, compare=False)

    @property
    def element_type(self) -> str:
        """The type of the field, or of one element if it is an array: ``string<=10``."""
        return self.type if self.limit is None else f"{self.type}<={self.limit}"

    @property
    def full_type(self) -> str:
        """The type as the definition spells it: ``float64[36]``."""
        return f"{self.element_type}{self.array or ''}"

    @property
    def ros1_type(self) -> str:
        """The type as ROS 1 spells it, without bounds: ``float64[]`` for ``[<=3]``."""
        array = Array(self.array.fixed) if self.array else ""
        return f"{'string' if self.type == 'wstring' else self.type}{array}"

    @property
    def is_nested(self) -> bool:
        """Whether the field holds another message, or several."""
        return self.type not in builtin.NAMES

    @property
    def is_bytes(self) -> bool:
        """Whether the field is a byte string: base64 in JSON."""
        return self.array is not None and self.type in builtin.BYTES

    @property
    def fixed_size(self) -> int:
        """The least number of elements of the array."""
        return (self.array and self.array.fixed) or 0

    @property
    def default_value(self) -> Scalar:
        """The default of a single value of a builtin type."""
        if self.default is None or isinstance(self.default, tuple):
            return builtin.zero(self.type)
        return self.default

    @property
    def default_elements(self) -> tuple[Scalar, ...]:
        """The default of an array of a builtin type."""
        if isinstance(self.default, tuple):
            return self.default
        return (builtin.zero(self.type),) * self.fixed_size


@dataclass(frozen=True, slots=True)
class Constant:
    """A named value; ``text`` is its spelling, which is part of the md5."""

    name: str
    type: str
    value: Scalar
    text: str


@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """A message: its text is in ROS 1's spelling, which every client's parser reads."""

    package: str
    name: str
    fields: tuple[Field, ...]
    constants: tuple[Constant, ...] = ()
    text: str = ""
    source: str = field(default="", compare=False)

    @property
    def type(self) -> str:
        """The full name, ``package/Name``."""
        return f"{self.package}/{self.name}"

    @property
    def has_header(self) -> bool:
        """Whether the first field is ``Header header``, where ROS expects a stamp."""
        first = self.fields[0] if self.fields else None
        return first == Field("header", builtin.HEADER)


@dataclass(frozen=True, slots=True)
class ServiceDefinition:
    """A service: its request and its response."""

    package: str
    name: str
    request: MessageDefinition
    response: MessageDefinition

    @property
    def type(self) -> str:
        """The full name, ``package/Name``."""
        return f"{self.package}/{self.name}"


ACTION_SUFFIXES = (
    "Action",
    "ActionFeedback",
    "ActionGoal",
    "ActionResult",
    "Feedback",
    "Goal",
    "Result",
)
"""The suffixes of the seven messages that actionlib makes of an action."""


@dataclass(frozen=True, slots=True)
class ActionDefinition:
    """An action: its goal, its result and its feedback."""

    package: str
    name: str
    goal: MessageDefinition
    result: MessageDefinition
    feedback: MessageDefinition

    @property
    def type(self) -> str:
        """The full name, ``package/Name``."""
        return f"{self.package}/{self.name}"

    def messages(self) -> tuple[MessageDefinition, ...]:
        """The seven messages that actionlib makes of an action, as its genaction.py writes them."""
        goal = self._message(
            "ActionGoal",
            Field("header", builtin.HEADER),
            Field("goal_id", "actionlib_msgs/GoalID"),
            Field("goal", self.goal.type),
        )
        result = self._message(
            "ActionResult",
            Field("header", builtin.HEADER),
            Field("status", "actionlib_msgs/GoalStatus"),
            Field("result", self.result.type),
        )
        feedback = self._message(
            "ActionFeedback",
            Field("header", builtin.HEADER),
            Field("status", "actionlib_msgs/GoalStatus"),
            Field("feedback", self.feedback.type),
        )
        action = self._message(
            "Action",
            Field("action_goal", goal.type),
            Field("action_result", result.type),
            Field("action_feedback", feedback.type),
        )
        return (action, goal, result, feedback, self.goal, self.result, self.feedback)

    def _message(self, suffix: str, *fields: Field) -> MessageDefinition:
        text = "".join(f"{field.full_type} {field.name}\n" for field in fields)
        return MessageDefinition(
            self.package, self.name + suffix, fields, text=text, source=self.goal.source
        )
