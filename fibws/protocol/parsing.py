"""From a JSON object to an operation, or to the text of what is wrong with it.

A field that is null counts as absent, as the real server has it. The texts are that server's own
(rosbridge_library's capability.py and protocol.py), which clients know.
"""

from __future__ import annotations

from itertools import islice
from typing import Annotated, Any, TypeVar, get_args

from pydantic import Field, TypeAdapter, ValidationError
from pydantic_core import to_json

from fibws.errors import OperationError
from fibws.protocol.operations import LONGEST_ID, Reply, Request

T = TypeVar("T")

QUOTED_LENGTH = 200
"""How much of a wrong message is repeated in the error about it, in characters."""

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
    "greater_than_equal": "an int from 0 to 6",
    "less_than_equal": "an int from 0 to 6",
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
    long = first["type"] == "string_too_long"
    wanted = (
        f"str{f' of at most {LONGEST_ID} characters' * long}, int"
        if name == "id"
        else _WANTED.get(first["type"]) or first.get("ctx", {}).get("expected", first["msg"])
    )
    return f"Expected field {name} to be one of {wanted}. Invalid value: {quoted(first['input'])}"


def quoted(value: Any) -> str:
    """A wrong value as JSON text, cut to a length that is fit to be read."""
    start = _start(value, QUOTED_LENGTH)
    text = to_json(start, inf_nan_mode="constants", bytes_mode="base64").decode()
    return text if len(text) <= QUOTED_LENGTH else f"{text[:QUOTED_LENGTH]}..."


def _start(value: Any, most: int) -> Any:
    """The start of a value, which may have millions of elements; its text is cut in any case."""
    if isinstance(value, list):
        return [_start(each, most // 2) for each in value[: most + 1]]
    if isinstance(value, dict):
        items = islice(value.items(), most + 1)
        return {name[: most + 1]: _start(each, most // 2) for name, each in items}
    return value[: QUOTED_LENGTH + 1] if isinstance(value, str | bytes) else value
