"""Invalid field values as JSON, and the fields that accept them nevertheless."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

from ..fakes import ADD, FIBONACCI

MISSING = ""
"""The field is left out."""

JUNK = {
    "missing": MISSING,
    "null": "null",
    "true": "true",
    "false": "false",
    "five": "5",
    "zero": "0",
    "minus zero": "-0",
    "minus zero float": "-0.0",
    "minus one": "-1",
    "fraction": "1.5",
    "whole float": "2.0",
    "10**400": "1" + "0" * 400,
    "-10**400": "-1" + "0" * 400,
    "1e400": "1e400",
    "NaN": "NaN",
    "-Infinity": "-Infinity",
    "empty text": '""',
    "text": '"no such thing"',
    "control characters": r'"\u0000\u001b[31m\n\u2028"',
    "wide characters": '"ä中\N{ROBOT FACE}"',
    "long text": '"' + "x" * 1_000_000 + '"',
    "empty list": "[]",
    "list": '[[1,"x"],{},null]',
    "long list": "[" + "0," * 100_000 + "0]",
    "empty object": "{}",
    "object": '{"a":{"b":[null]}}',
    "nested lists": "[" * 150 + "]" * 150,
    "nested objects": '{"a":' * 150 + "1" + "}" * 150,
}
UNREADABLE = {
    "half of a pair": r'"\ud800"',
    "the other half": r'"a\udc00"',
    "100000 brackets": "[" * 100_000 + "]" * 100_000,
    "100000 braces": '{"a":' * 100_000 + "1" + "}" * 100_000,
    "5000 digits": "1" * 5000,
    "no JSON": "undefined",
}
"""Values that make the whole text invalid JSON."""

ABSENT = {"missing", "null"}
TEXTS = {"empty text", "text", "control characters", "wide characters", "long text"}
INTEGERS = {"five", "zero", "minus zero", "minus one", "10**400", "-10**400"}
FINITE = {"five", "zero", "minus zero", "minus zero float", "minus one", "fraction", "whole float"}
NUMBERS = INTEGERS | FINITE | {"1e400", "NaN", "-Infinity"}
BOOLEANS = {"true", "false"}
OBJECTS = {"empty object", "object", "nested objects"}


@dataclass(frozen=True)
class Kind:
    """The values that a kind of field accepts.

    ``refusal`` matches the errors about all others; ``{0}`` is the field's name.
    """

    takes: set[str]
    why: str
    refusal: str = r"(Expected field {0} to be one of|Expected a {0} field but none was found)"

    def error(self, field: str) -> re.Pattern[str]:
        return re.compile(self.refusal.format(field))


NAME = Kind({"wide characters"}, "names need not be legal", Kind.refusal + "|is not a legal name")
KINDS = {
    "id": Kind(
        (ABSENT | NUMBERS | TEXTS | BOOLEANS) - {"long text"},
        "clients have ids of all sorts, but what is kept of them is bounded",
    ),
    "topic": NAME,
    "service": NAME,
    "action": NAME,
    "type": Kind(set(), "no junk is a type", Kind.refusal + "|is not a valid type string"),
    "action_type": Kind(set(), "no junk is a type", Kind.refusal + "|is not a valid type string"),
    "definition": Kind(ABSENT, "it is optional", Kind.refusal + "|[Dd]efinition|line 1"),
    "latch": Kind(ABSENT | BOOLEANS, "it is optional"),
    "headers": Kind(ABSENT | BOOLEANS, "it is optional"),
    "header": Kind({*JUNK}, "it is the hub's to say"),
    "peers": Kind(ABSENT | BOOLEANS, "it is optional"),
    "peer_changes": Kind(ABSENT | BOOLEANS, "it is optional"),
    "keep_seq": Kind(ABSENT | BOOLEANS, "it is optional"),
    "send_definition": Kind(ABSENT | BOOLEANS, "it is optional"),
    "publisher": Kind(ABSENT | {"five", "zero", "minus zero"}, "it is optional"),
    "md5sum": Kind(ABSENT, "it is optional", NAME.refusal + "|md5sum"),
    "code": Kind(ABSENT | TEXTS, "only the hub's own codes matter"),
    "to": Kind(ABSENT | NAME.takes, "it is optional", NAME.refusal),
    "feedback": Kind(ABSENT | BOOLEANS, "it is optional"),
    "result": Kind(BOOLEANS, "either may be"),
    "queue_size": Kind(ABSENT | INTEGERS, "any integer is a length"),
    "queue_length": Kind(ABSENT | INTEGERS, "any integer is a length"),
    "throttle_rate": Kind(ABSENT | FINITE, "what is below 0 counts as 0"),
    "timeout": Kind(ABSENT | FINITE, "what is not above 0 counts as absent"),
    "fragment_size": Kind(ABSENT | INTEGERS, "what is not above 0 counts as absent"),
    "compression": Kind(ABSENT | TEXTS, "unknown compressions count as none"),
    "int64": Kind(ABSENT, "there is one spelling"),
    "credit": Kind(ABSENT, "it is optional", Kind.refusal + "|needs serialized messages"),
    "count": Kind(ABSENT | {"five", "10**400"}, "more than all is all"),
    "status": Kind(ABSENT | {"five", "zero", "minus zero"}, "there are those from 0 to 6"),
    "level": Kind(set(), "there are four"),
    "msg": Kind(ABSENT | {"empty object"}, "None stands for the default", "std_msgs/Int32"),
    "args": Kind(
        {*JUNK} - {"list", "object", "nested lists", "nested objects"},
        "what is neither object nor list counts as absent, and so do items beyond the fields",
        "AddTwoIntsRequest|FibonacciGoal",
    ),
    "values": Kind(ABSENT | {"empty object"}, "None stands for the defaults", "Fibonacci|AddTwo"),
    "data": Kind(TEXTS, "it is put together before it is read"),
    "num": Kind({"zero", "minus zero"}, "there are two", Kind.refusal + "|num must be from 0"),
    "token": Kind(ABSENT | TEXTS, "it is ignored without authentication"),
    "total": Kind({"five", "10**400"}, "only what has come takes room", Kind.refusal + "|num must"),
}
"""The kinds of fields by their names."""

ECHO = Kind(TEXTS, "the id alone counts, the name is only repeated")
HEADERS = Kind(ABSENT | {"empty object"}, "it is optional")
KNOWN = Kind(set(), "nobody serves it", NAME.refusal + "|does not exist")
UNKNOWN = Kind(TEXTS, "what was never there may be taken back")
OTHER_MD5 = Kind(ABSENT | TEXTS - {"long text"}, "servers of another definition get JSON")
EXCEPTIONS = {
    ("advertise", "definition"): Kind(
        ABSENT | {"empty text"}, "it is optional, and a message may be empty", "Expected|line 1|The"
    ),
    ("subscribe", "definition"): Kind(
        ABSENT | {"empty text"}, "it is optional, and a message may be empty", "Expected|line 1|The"
    ),
    ("advertise", "headers"): HEADERS,
    ("call_service", "headers"): HEADERS,
    ("advertise_service", "md5sum"): OTHER_MD5,
    ("advertise_action", "md5sum"): OTHER_MD5,
    ("call_service", "service"): KNOWN,
    ("send_action_goal", "action"): KNOWN,
    ("unadvertise", "topic"): UNKNOWN,
    ("unsubscribe", "topic"): UNKNOWN,
    ("acknowledge", "topic"): UNKNOWN,
    ("subscribe", "type"): Kind(ABSENT, "it is optional", KINDS["type"].refusal),
    ("unadvertise_service", "service"): Kind(
        ABSENT | NAME.takes, "ros-sharp sends none", NAME.refusal
    ),
    ("clear_will", "topic"): UNKNOWN,
    ("set_will", "type"): Kind(set(), "the topic has none", KINDS["type"].refusal + "|no type"),
    ("set_will", "timeout"): Kind(
        ABSENT | {"five", "fraction", "whole float"}, "it is optional, and bounded"
    ),
    ("service_response", "service"): ECHO,
    ("cancel_action_goal", "action"): ECHO,
    ("cancel_action_goal", "id"): Kind(
        set(), "the client has sent no such goal", Kind.refusal + "|no goal of"
    ),
    ("action_feedback", "action"): ECHO,
    ("action_result", "action"): ECHO,
    ("fragment", "id"): Kind(INTEGERS | TEXTS, "fragments must have one, of these types"),
}
"""Fields whose kind depends on the operation."""

SCENE: list[tuple[str, dict[str, Any]]] = [
    ("advertise_service", {"service": "/mine", "type": ADD}),
    ("advertise_action", {"action": "/goal", "type": FIBONACCI}),
    ("call_service", {"service": "/mine"}),
    ("send_action_goal", {"action": "/goal", "action_type": FIBONACCI, "id": "sent"}),
]
"""The operations before the invalid one: the client serves and calls itself."""

VALID: dict[str, dict[str, Any]] = {
    "advertise": {"topic": "/t", "type": "my_msgs/T", "definition": "int8 a"},
    "unadvertise": {"topic": "/t"},
    "publish": {"topic": "/known", "msg": {"data": 5}},
    "subscribe": {"topic": "/t", "type": "std_msgs/Int32"},
    "unsubscribe": {"topic": "/t"},
    "acknowledge": {"topic": "/t"},
    "call_service": {"service": "/mine", "args": {"a": 1}},
    "advertise_service": {"service": "/t", "type": "my_srvs/T", "definition": "int8 a\n---"},
    "unadvertise_service": {"service": "/t"},
    "service_response": {
        "service": "/mine",
        "id": "service_request:/mine:secret-1",
        "values": {"sum": 1},
        "result": True,
    },
    "advertise_action": {
        "action": "/t",
        "type": "my_actions/T",
        "definition": "int8 a\n---\n---",
    },
    "unadvertise_action": {"action": "/t"},
    "send_action_goal": {"action": "/goal", "action_type": FIBONACCI, "args": {"order": 1}},
    "cancel_action_goal": {"action": "/goal", "id": "sent"},
    "action_feedback": {"action": "/goal", "id": "action_goal:/goal:2", "values": {}},
    "action_result": {"action": "/goal", "id": "action_goal:/goal:2", "result": True},
    "set_will": {"topic": "/t", "type": "std_msgs/Int32", "msg": {"data": 5}},
    "clear_will": {"topic": "/t"},
    "fragment": {"id": "f", "data": "x", "num": 0, "total": 2},
    "auth": {"token": "x"},
    "set_level": {"level": "error"},
}
"""A valid operation of each name."""


def kind_of(op: str, field: str) -> Kind:
    """Return the kind of an operation's field."""
    return EXCEPTIONS.get((op, field)) or KINDS[field]
