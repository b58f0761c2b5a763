"""The operations of the rosbridge v2.0 protocol, one frozen model each.

Fields that a client sends and no model names are ignored, and a field that is null counts as
absent, as the real server does. A new operation is a model here and a case in `hub/session.py`,
which does not type-check until it has one.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError
from pydantic_core import to_json

from fibws.errors import OperationError

T = TypeVar("T")
Id = str | int | float | bool | None
Level = Literal["error", "warning", "info", "none"]

QUOTED_LENGTH = 200
"""How much of a wrong message is repeated in the error about it, in characters."""


class Operation(BaseModel):
    """What every operation has: a name, and an id that answers carry back as it was sent."""

    model_config = ConfigDict(frozen=True, strict=True, extra="ignore")

    id: Id = None


class Advertise(Operation):
    """The client will publish on ``topic``."""

    op: Literal["advertise"] = "advertise"
    topic: str
    type: str
    latch: bool = False
    queue_size: int = 100
    definition: str | None = None
    """The type's .msg text, for types that the hub does not have (an addition of fibws)."""


class Unadvertise(Operation):
    """The client will publish no more on ``topic``; without an id, for all its advertisements."""

    op: Literal["unadvertise"] = "unadvertise"
    topic: str


class Publish(Operation):
    """One message, either way; ``msg`` of None stands for the type's default message."""

    op: Literal["publish"] = "publish"
    topic: str
    msg: Any = None
    latch: bool = False


class Subscribe(Operation):
    """The client wants the messages of ``topic``; ``throttle_rate`` is in milliseconds."""

    op: Literal["subscribe"] = "subscribe"
    topic: str
    type: str | None = None
    throttle_rate: Annotated[float, Field(allow_inf_nan=False)] = 0
    queue_length: int = 0
    fragment_size: int | None = None
    compression: str = "none"


class Unsubscribe(Operation):
    """The client wants no more of ``topic``; without an id, for all its subscriptions."""

    op: Literal["unsubscribe"] = "unsubscribe"
    topic: str


class Fragment(Operation):
    """One of ``total`` pieces of the text of another operation, counted from 0."""

    op: Literal["fragment"] = "fragment"
    id: str | int
    data: str
    num: int
    total: int


class SetLevel(Operation):
    """Which statuses the client wants to be sent: this level and what is graver."""

    op: Literal["set_level"] = "set_level"
    level: Level


class Status(Operation):
    """What the hub has to say about an operation of the client's, named by its id."""

    op: Literal["status"] = "status"
    level: Level
    msg: str


Request = Advertise | Unadvertise | Publish | Subscribe | Unsubscribe | Fragment | SetLevel
"""What a client may send."""

Reply = Publish | Status
"""What a client may be sent."""

_REQUEST: TypeAdapter[Request] = TypeAdapter(Annotated[Request, Field(discriminator="op")])
_REPLY: TypeAdapter[Reply] = TypeAdapter(Annotated[Reply, Field(discriminator="op")])
REQUESTS = sorted(model.model_fields["op"].default for model in get_args(Request))
REPLIES = sorted(model.model_fields["op"].default for model in get_args(Reply))


def parse_request(fields: dict[str, Any]) -> Request:
    """The operation that a client sent.

    Raises:
        OperationError: there is no such operation, or a field is missing or of a wrong type.
    """
    return _parse(_REQUEST, REQUESTS, fields)


def parse_reply(fields: dict[str, Any]) -> Reply:
    """The operation that the hub sent; raises as `parse_request` does."""
    return _parse(_REPLY, REPLIES, fields)


def encode(operation: Operation) -> bytes:
    """The operation as JSON text, ``op`` first, without the fields that are None."""
    fields = operation.model_dump(exclude_none=True)
    return to_json({"op": fields.pop("op"), **fields}, inf_nan_mode="null")


def _parse(adapter: TypeAdapter[T], known: list[str], fields: dict[str, Any]) -> T:
    if None in fields.values():
        fields = {name: value for name, value in fields.items() if value is not None}
    try:
        return adapter.validate_python(fields)
    except ValidationError as error:
        raise OperationError(_fault(error, known, fields)) from None


_WANTED = {
    "string_type": "str",
    "bool_type": "bool",
    "int_type": "int",
    "int_from_float": "int",
    "float_type": "int, float",
    "finite_number": "a finite number",
}


def _fault(error: ValidationError, known: list[str], fields: dict[str, Any]) -> str:
    """The first fault, in the real server's words (rosbridge_library's capability.py)."""
    first = error.errors(include_url=False, include_context=True)[0]
    operation = fields.get("op")
    if first["type"] == "union_tag_not_found" or not isinstance(operation, str):
        return (
            "Received a message without an op.  All messages require 'op' field with value one of: "
            f"{known}.  Original message was: {quoted(fields)}"
        )
    if first["type"] == "union_tag_invalid":
        return f"Unknown operation: {operation}.  Allowed operations: {known}"
    name = str(first["loc"][1])
    if first["type"] == "missing":
        return f"Expected a {name} field but none was found."
    wanted = (
        "str, int"
        if name == "id"
        else _WANTED.get(first["type"]) or first.get("ctx", {}).get("expected", first["msg"])
    )
    return f"Expected field {name} to be one of {wanted}. Invalid value: {quoted(first['input'])}"


def quoted(value: Any) -> str:
    """A wrong value as JSON text, cut to a length that is fit to be read."""
    text = to_json(value, inf_nan_mode="constants").decode()
    return text if len(text) <= QUOTED_LENGTH else f"{text[:QUOTED_LENGTH]}..."
