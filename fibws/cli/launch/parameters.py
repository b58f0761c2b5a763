"""What a launch does to the parameters before any node runs."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from fibws.client.hub_client import HubClient
from fibws.errors import InvalidValue
from fibws.ros1.launch.model import Launch, Step
from fibws.values import parameter_files

ROOT = "/"

Say = Callable[[str], None]


def prepare(client: HubClient, launch: Launch, say: Say) -> Iterator[None]:
    """Dump and delete, clear, and set what a launch's files say, in this order.

    It yields behind each step, for whoever wants to break it off there.

    Args:
        client: to the hub.
        launch: what was read.
        say: is given what a person should know.

    Raises:
        ServiceError: the hub refuses a parameter.
        OSError: a file cannot be written.
    """
    for step in launch.steps:
        _do(client, step, say)
        yield
    for name in _outermost(launch.cleared):
        if name == ROOT:
            _ask(client, "set_param", name=ROOT, value="{}")
        elif _has(client, name):
            _ask(client, "delete_param", name=name)
        yield
    for name, value in launch.parameters.items():
        if isinstance(value, bytes):
            say(f"{name}: parameters hold no bytes here, so this is their base64")
            value = b64encode(value).decode()
        _ask(client, "set_param", name=name, value=json.dumps(value, ensure_ascii=False))
        yield


def read_yaml(text: str) -> Any:
    """The value of a text in YAML, with angles as rosparam has them.

    Raises:
        ValueError: it is none.
    """
    import yaml

    from fibws.values import parsing

    try:
        value = yaml.load(text, parameter_files.loader())
        parsing.check_size(value)
    except (yaml.YAMLError, *parsing.FAULTS) as error:
        raise ValueError(parsing.fault(error)) from None
    except InvalidValue as error:  # It is too large; the reader adds the line.
        raise ValueError(str(error)) from None
    return value


def _do(client: HubClient, step: Step, say: Say) -> None:
    if not _has(client, step.name):
        say(f"rosparam {step.command} {step.name}: it is not set")
    elif step.command == "delete":
        _ask(client, "delete_param", name=step.name)
    else:
        value = json.loads(_ask(client, "get_param", name=step.name)["value"])
        Path(step.file).write_text(parameter_files.dumped(value), "utf-8")


def _outermost(names: list[str]) -> list[str]:
    """The names that are in no other one: what is in it is gone with that."""
    found = dict.fromkeys(names)
    return [
        name
        for name in found
        if not any(name != each and f"{name}/".startswith(f"{each.rstrip('/')}/") for each in found)
    ]


def _has(client: HubClient, name: str) -> bool:
    return name == ROOT or bool(_ask(client, "has_param", name=name)["exists"])


def _ask(client: HubClient, service: str, **request: str) -> dict[str, Any]:
    return client.call(f"/rosapi/{service}", request)
