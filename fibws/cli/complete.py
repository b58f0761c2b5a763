"""What a shell completes: names from the live hub, for ``shell_complete=`` of an argument.

A shell waits for these, and whoever types does, too. So they take what the hub says within a
moment, and nothing where there is no hub.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, TypeAlias

import click

from fibws import names
from fibws.client.hub_client import HubClient
from fibws.definition_folders import STANDARD, named_folders
from fibws.errors import FibwsError, InvalidName

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

PATIENCE = 0.3
"""Seconds in which a hub must have answered."""

Found: TypeAlias = dict[str, str]
"""Names, each with a word that a shell may show beside it: what type it is of."""
Completion: TypeAlias = "Callable[[click.Context, click.Parameter, str], list[CompletionItem]]"


def completion(ask: Callable[[HubClient], Found]) -> Completion:
    """What completes by asking the hub; ``ask`` gives global names."""

    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return _items(_asked(ask, context.params.get("hub")), incomplete)

    return complete


def _topics(client: HubClient) -> Found:
    found = client.call("/rosapi/topics")
    return dict(zip(found["topics"], found["types"], strict=True))


def _nodes(client: HubClient) -> Found:
    return {name: "" for name in client.call("/rosapi/nodes")["nodes"] if name != client.node}


def _services(client: HubClient) -> Found:
    return {each["name"]: each["type"] for each in client.call("/rosapi/graph")["services"]}


def _actions(client: HubClient) -> Found:
    return {each["name"]: each["type"] for each in client.call("/rosapi/graph")["actions"]}


def _params(client: HubClient) -> Found:
    return {name: "" for name in client.call("/rosapi/get_param_names")["names"]}


topics = completion(_topics)
"""Topics that are published or subscribed to."""
nodes = completion(_nodes)
"""Nodes, but for that of whoever asks."""
services = completion(_services)
"""Services, the hub's own among them."""
actions = completion(_actions)
"""Actions, those over topics among them."""
params = completion(_params)
"""Parameters."""


def defined(kind: str, *, short: bool = False) -> Completion:
    """What completes types of a kind (msg, srv, action) that fibws or $FIBWS_INTERFACES has.

    Args:
        kind: theirs.
        short: whether they may also be named without their package, once a part of that is there.
    """

    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        found = _types(kind)
        if short and incomplete:
            found |= {name.partition("/")[2] for name in found}
        return _beginning(found, incomplete)

    return complete


def packages(kind: str) -> Completion:
    """What completes packages that have types of a kind; otherwise as `defined`."""

    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return _beginning({name.partition("/")[0] for name in _types(kind)}, incomplete)

    return complete


types = defined("msg")
"""Types of messages."""
service_types = defined("srv")
"""Types of services."""


def type_of_topic(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """The type that the command's topic has, or else as `types`."""
    topic = context.params.get("topic") or ""

    def ask(client: HubClient) -> Found:
        return {client.call("/rosapi/topic_type", {"topic": client.resolve(topic)})["type"]: ""}

    found = {name for name in _asked(ask, context.params.get("hub")) if _is_type(name)}
    return _beginning(found or _types("msg"), incomplete)


def _asked(ask: Callable[[HubClient], Found], hub: str | None) -> Found:
    found: Found = {}

    def answer() -> None:
        try:
            with HubClient("completion", hub) as client:
                found.update(ask(client))
        except (FibwsError, KeyError, TypeError, ValueError):
            pass  # No hub, or none of this kind: there is nothing to complete from.

    # A look-up of a host's name heeds no time limit, but nobody needs to wait for a thread.
    thread = Thread(target=answer, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return dict(found)


def _items(found: Found, incomplete: str) -> list[CompletionItem]:
    """Those that begin so, relative to the namespace if that is how they are being spelled."""
    relative = incomplete != "" and not incomplete.startswith("/")
    base = _namespace().rstrip("/") + "/" if relative else ""
    return [
        _item(name.removeprefix(base), type_ if _is_type(type_) else "")
        for name, type_ in sorted(found.items())
        if name.startswith(base + incomplete) and _is_name(name)
    ]


def _item(name: str, help_: str = "") -> CompletionItem:
    from click.shell_completion import CompletionItem  # which only a shell has a use for

    return CompletionItem(name, help=help_ or None)


def _namespace() -> str:
    try:
        return names.check_namespace(os.environ.get("ROS_NAMESPACE", "/"))
    except InvalidName:
        return "/"


def _is_name(name: str) -> bool:
    """Whether it is a name and no more: a shell must not be given ``$(...)`` by somebody's hub."""
    try:
        names.check(name)
    except InvalidName:
        return False
    return name.startswith("/")


def _is_type(name: str) -> bool:
    package, _, type_ = name.partition("/")
    return package.isidentifier() and type_.isidentifier()


def _beginning(found: Iterable[str], incomplete: str) -> list[CompletionItem]:
    return [_item(name) for name in sorted(found) if name.startswith(incomplete)]


def _types(kind: str) -> set[str]:
    """The names of types by their files, as no definition needs to be read for that."""
    folders = [STANDARD, *map(Path, named_folders())]
    return {name for folder in folders for name in _types_in(folder, kind)}


def _types_in(folder: Path, kind: str) -> Iterable[str]:
    """The types in a folder of packages, or in one that is a package itself."""
    for path in (*folder.glob(f"*/{kind}/*.{kind}"), *folder.glob(f"{kind}/*.{kind}")):
        name = f"{path.absolute().parts[-3]}/{path.stem}"
        if _is_type(name):
            yield name
