"""What precedes a launch's nodes at the hub: <rosparam> commands, and parameters."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from fibws.client.hub_client import HubClient
from fibws.client.parameters import HubParameters
from fibws.errors import ParameterNotSet, ServiceError
from fibws.ros1.launch.model import CORE_PARAMETERS, Launch, RosparamStep
from fibws.values import parameter_files


def prepare(client: HubClient, launch: Launch, warn: Callable[[str], None]) -> Iterator[None]:
    """Run <rosparam> commands, clear namespaces, and set parameters, in this order.

    It yields after each step, so that its caller can stop there.

    Args:
        client: a client of the hub.
        launch: the content of the launch files.
        warn: called with warnings.

    Raises:
        ServiceError: the hub refuses a parameter.
        OSError: a file cannot be written.
    """
    parameters = HubParameters(client.call)
    for step in launch.steps:
        _run_step(parameters, step, warn)
        yield
    for name in _outermost(launch.cleared):
        with suppress(ParameterNotSet):
            parameters.delete(name)
        yield
    for name, value in launch.parameters.items():
        if isinstance(value, bytes):
            warn(f"{name}: parameters cannot hold bytes; setting their base64")
            value = b64encode(value).decode()
        if CORE_PARAMETERS.get(name) == value and _has(parameters, name, value):
            continue  # The hub's own, which not every token may set.
        parameters.set_json(name, json.dumps(value, ensure_ascii=False))
        yield


def _has(parameters: HubParameters, name: str, value: Any) -> bool:
    try:
        return bool(parameters.get(name) == value)
    except (ParameterNotSet, ServiceError):
        return False


def _run_step(parameters: HubParameters, step: RosparamStep, warn: Callable[[str], None]) -> None:
    try:
        if step.command == "delete":
            parameters.delete(step.name)
        else:
            value = parameters.get(step.name)
            Path(step.file).write_text(parameter_files.dumped(value), "utf-8")
    except ParameterNotSet:
        warn(f"rosparam {step.command} {step.name}: parameter not set")


def _outermost(names: list[str]) -> list[str]:
    """Return the names that are not in the namespace of another one."""
    found = dict.fromkeys(names)
    return [
        name
        for name in found
        if not any(name != each and f"{name}/".startswith(f"{each.rstrip('/')}/") for each in found)
    ]
