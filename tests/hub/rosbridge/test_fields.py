"""Every field of every operation with every invalid value.

The operations and their fields are the models': a new one is tested as soon as `junk` says what is
right for it, and fails until then.
"""

from __future__ import annotations

import json
from typing import Any, get_args

import pytest

from fibws.protocol.operations import Request

from ..fakes import INT32, Client, FakeHub, number
from .invalid_values import ABSENT, JUNK, MISSING, SCENE, UNREADABLE, VALID, kind_of

OPERATIONS = {model.model_fields["op"].default: model for model in get_args(Request)}
FIELDS = [(op, field) for op, model in OPERATIONS.items() for field in model.model_fields]
PLAIN = [(op, field) for op, field in FIELDS if field != "op"]


@pytest.fixture(autouse=True)
def known_secret(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the ids of calls be those of `VALID`."""
    monkeypatch.setattr("fibws.hub.rosbridge.services.secrets.token_hex", lambda size: "secret")


class Company:
    """A client that sends invalid operations, and two that communicate meanwhile."""

    def __init__(self, hub: FakeHub) -> None:
        self.hub = hub
        self.talker, self.listener = hub.client("/talker"), hub.client("/listener")
        for topic in ("/numbers", "/known"):
            self.talker.send("advertise", topic, type=INT32)
        self.listener.send("subscribe", "/numbers")
        self.client = hub.client("/erring")
        for op, fields in SCENE:
            self.client.send(op, **fields)
        ids = [each["id"] for each in self.client.receive()]
        assert ids == [VALID["service_response"]["id"], VALID["action_result"]["id"]]

    def errors(self) -> list[str]:
        """Return the errors that the client of the invalid operation got.

        As its own server it may get the error in a status and in the response to its call.
        """
        received = [each for each in self.client.receive() if _is_fault(each)]
        assert len({each["op"] for each in received}) == len(received)
        texts: list[str] = [each.get("msg") or each["values"] for each in received]
        assert all(len(text) <= 1003 for text in texts)
        return texts

    def part(self) -> None:
        """Check that the client goes on and that the others lost nothing; then all leave."""
        self.client.send("fly", id="still here")
        assert [each["id"] for each in self.client.receive()] == ["still here"]
        self.talker.send("publish", "/numbers", msg=number(1))
        assert self.listener.receive_numbers("/numbers") == [1]
        assert self.talker.receive() == []
        everyone = (self.client, self.talker, self.listener)
        assert not any(each.closings for each in everyone)
        for each in everyone:
            each.disconnect()
            assert each.forgotten
        assert self.hub.empty
        assert self.hub.clock.timers == 0


def _is_fault(received: dict[str, Any]) -> bool:
    if received["op"] in ("service_response", "action_result"):
        return not received["result"] and received["values"] != "the goal failed"
    return bool(received["op"] == "status")


def operation(op: str, field: str, value: str) -> str:
    """Return the JSON of an operation with this value in one of its fields."""
    fields = {name: json.dumps(each) for name, each in {"op": op, **VALID[op]}.items()}
    fields[field] = value
    members = (f'"{name}":{text}' for name, text in fields.items() if text != MISSING)
    return "{" + ",".join(members) + "}"


def new_company(hub: FakeHub, field: str) -> Company:
    # A definition that was learned would be compared with the next one.
    return Company(FakeHub() if field in ("definition", "type") else hub)


@pytest.mark.parametrize("op", OPERATIONS)
def test_valid_operations_are_accepted(op: str) -> None:
    company = Company(FakeHub())
    company.client.send_text(json.dumps({"op": op, **VALID[op]}))
    assert company.errors() == []
    company.part()


@pytest.mark.parametrize(("op", "field"), PLAIN)
def test_invalid_values_are_refused_by_the_name_of_their_field(op: str, field: str) -> None:
    hub, kind = FakeHub(), kind_of(op, field)
    seen = {}
    for label, value in JUNK.items():
        company = new_company(hub, field)
        company.client.send_text(operation(op, field, value))
        seen[label] = company.errors()
        company.part()
    refused = {label for label, errors in seen.items() if errors}
    assert refused == JUNK.keys() - kind.takes, kind.why
    for label in refused:
        for error in seen[label]:
            assert kind.error(field).search(error), f"{label}: {error}"


@pytest.mark.parametrize(("op", "field"), FIELDS)
def test_text_with_invalid_json_is_refused(op: str, field: str) -> None:
    hub = FakeHub()
    for label, value in UNREADABLE.items():
        company = Company(hub)
        company.client.send_text(operation(op, field, value))
        [error] = company.errors()
        assert error.startswith("Expected JSON objects: "), label
        company.part()


@pytest.mark.parametrize("op", OPERATIONS)
def test_unknown_operation_names_are_refused(op: str) -> None:
    hub = FakeHub()
    for label, value in JUNK.items():
        company = Company(hub)
        company.client.send_text(operation(op, "op", value))
        [error] = company.errors()
        unknown = isinstance(json.loads(value or "null"), str)
        text = "Unknown operation: " if unknown else "Received a message without an op."
        assert error.startswith(text), label
        company.part()


@pytest.mark.parametrize("op", OPERATIONS)
def test_unknown_fields_are_ignored(op: str) -> None:
    hub = FakeHub()
    for value in (*JUNK.values(), '{"op":"publish","topic":"/numbers","msg":{"data":2}}'):
        company = Company(hub)
        # One hub learns a definition only once.
        company.client.send_text(operation(op, "no such field", value))
        assert company.errors() == []
        company.part()


@pytest.mark.parametrize("op", OPERATIONS)
def test_operations_without_fields_name_the_first_missing_one(op: str) -> None:
    company = Company(FakeHub())
    company.client.send(op)
    model = OPERATIONS[op]
    required = [name for name, field in model.model_fields.items() if field.is_required()]
    if required:
        [error] = company.errors()
        assert error == f"{op}: Expected a {required[0]} field but none was found."
    else:
        assert company.errors() == []
    company.part()


@pytest.mark.parametrize("op", OPERATIONS)
def test_status_about_a_field_carries_the_operations_id(op: str) -> None:
    model = OPERATIONS[op]
    required = [name for name, field in model.model_fields.items() if field.is_required()]
    for field in required:
        company = Company(FakeHub())
        fields = {**VALID[op], "id": "the id", field: ["wrong"]}
        company.client.send_text(json.dumps({"op": op, **fields}))
        [status] = [each for each in company.client.receive() if each["op"] == "status"]
        assert status.get("id") == (None if field == "id" else "the id")
        company.part()


def test_tables_name_only_existing_fields() -> None:
    assert VALID.keys() == OPERATIONS.keys()
    for op, fields in VALID.items():
        assert fields.keys() <= OPERATIONS[op].model_fields.keys()
    for op, field in PLAIN:
        assert kind_of(op, field).takes <= JUNK.keys()
    assert JUNK["missing"] == MISSING
    assert ABSENT <= JUNK.keys()


@pytest.mark.parametrize(
    ("op", "field"), [(op, field) for op, field in PLAIN if field in VALID.get(op, {})]
)
def test_thousand_invalid_operations_in_one_text_do_no_harm(op: str, field: str) -> None:
    company = Company(FakeHub())
    text = operation(op, field, '{"wrong":[1]}')
    company.client.send_text(text * 1000)
    others: list[Client] = [company.talker, company.listener]
    assert [each.receive() for each in others] == [[], []]
    assert len(company.client.receive()) <= 2000
    company.part()
