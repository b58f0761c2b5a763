"""What a launch does to the parameters before any node runs."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import click

from fibws.cli.link import Link
from fibws.cli.param import documents
from fibws.launch.model import Launch, Step

ROOT = "/"

Say = Callable[[str], None]


def prepare(link: Link, launch: Launch, say: Say) -> Iterator[None]:
    """Dump and delete, clear, and set what a launch's files say, in this order.

    It yields behind each step, for whoever wants to break it off there.

    Args:
        link: to the hub.
        launch: what was read.
        say: is given what a person should know.

    Raises:
        ServiceError: the hub refuses a parameter.
        OSError: a file cannot be written.
    """
    for step in launch.steps:
        _do(link, step, say)
        yield
    for name in _outermost(launch.cleared):
        if name == ROOT:
            _ask(link, "set_param", name=ROOT, value="{}")
        elif _has(link, name):
            _ask(link, "delete_param", name=name)
        yield
    for name, value in launch.parameters.items():
        if isinstance(value, bytes):
            say(f"{name}: parameters hold no bytes here, so this is their base64")
            value = b64encode(value).decode()
        _ask(link, "set_param", name=name, value=json.dumps(value, ensure_ascii=False))
        yield


def read_yaml(text: str) -> Any:
    """The value of a text in YAML, with angles as rosparam has them.

    Raises:
        ValueError: it is none.
    """
    import yaml

    from fibws.cli.message import reading

    try:
        value = yaml.load(text, documents.loader())
        reading.check_size(value)
    except (yaml.YAMLError, *reading.FAULTS) as error:
        raise ValueError(reading.fault(error)) from None
    except click.ClickException as error:  # It is too large; the reader tells in which line.
        raise ValueError(error.message) from None
    return value


def _do(link: Link, step: Step, say: Say) -> None:
    if not _has(link, step.name):
        say(f"rosparam {step.command} {step.name}: it is not set")
    elif step.command == "delete":
        _ask(link, "delete_param", name=step.name)
    else:
        value = json.loads(_ask(link, "get_param", name=step.name)["value"])
        Path(step.file).write_text(documents.dumped(value), "utf-8")


def _outermost(names: list[str]) -> list[str]:
    """The names that are in no other one: what is in it is gone with that."""
    found = dict.fromkeys(names)
    return [
        name
        for name in found
        if not any(name != each and f"{name}/".startswith(f"{each.rstrip('/')}/") for each in found)
    ]


def _has(link: Link, name: str) -> bool:
    return name == ROOT or bool(_ask(link, "has_param", name=name)["exists"])


def _ask(link: Link, service: str, **request: str) -> dict[str, Any]:
    return link.call(f"/rosapi/{service}", request)
