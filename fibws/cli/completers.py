"""Completions of arguments for ``shell_complete=``: names from the hub, types from files.

A person waits for these, so a hub that does not answer in a moment gives none.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, TypeAlias

import click

from fibws import names
from fibws.cli.type_names import is_type
from fibws.client.graph_snapshot import GraphSnapshot
from fibws.client.hub_client import HubClient
from fibws.definition_folders import STANDARD, named_folders
from fibws.errors import FibwsError, InvalidName
from fibws.values.typedefs import TypedefField, Typedefs

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

QUOTED = "quoted"
"""The type of a completion that a shell must quote, because it has spaces and braces."""
LONGEST_TEMPLATE = 4000
"""Characters of a message that a person could edit in a terminal."""
PATIENCE = 0.3
"""Seconds to wait for the hub."""

Found: TypeAlias = dict[str, str]
"""Names and their types, which a shell may show beside them."""
Completion: TypeAlias = "Callable[[click.Context, click.Parameter, str], list[CompletionItem]]"


def completion(ask: Callable[[HubClient], Found]) -> Completion:
    """Return a completion of the global names that ``ask`` gets from the hub."""

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
"""All topics."""
nodes = completion(_nodes)
"""All nodes, except the shell's own."""
services = completion(_services)
"""All services, including the hub's own."""
actions = completion(_actions)
"""All actions, including those over topics."""
params = completion(_params)
"""All parameters."""


def files(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete the names of files, as the shell does."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(incomplete, type="file")]


def defined(kind: str, *, short: bool = False) -> Completion:
    """Return a completion of the types in fibws and $FIBWS_INTERFACES.

    Args:
        kind: ``msg``, ``srv`` or ``action``.
        short: also complete names without their package, once a letter is typed.
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
    """Return a completion of the packages that define types of a kind; see `defined`."""

    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        return _beginning({name.partition("/")[0] for name in _types(kind)}, incomplete)

    return complete


types = defined("msg")
"""Message types."""
service_types = defined("srv")
"""Service types."""


def type_of_topic(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete the type of the command's topic; message types if that is unknown."""
    topic = context.params.get("topic") or ""

    def ask(client: HubClient) -> Found:
        return {client.call("/rosapi/topic_type", {"topic": client.resolve(topic)})["type"]: ""}

    found = {name for name in _asked(ask, context.params.get("hub")) if is_type(name)}
    return _beginning(found or _types("msg"), incomplete)


def template(request: Callable[[HubClient, click.Context], Typedefs]) -> Completion:
    """Return a completion of a command's values: a message of defaults in one line, to be edited.

    Args:
        request: requests the message's type from the hub.
    """

    def complete(
        context: click.Context, parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        values = context.params.get(parameter.name or "")
        if incomplete or (values and not _typed_type(context)):
            return []  # A value was typed already.

        def ask(client: HubClient) -> Found:
            typedefs = request(client, context)
            return {_one_line(typedefs.default(TypedefField("", typedefs.root))): ""}

        found = _asked(ask, context.params.get("hub"))
        return [_item(text, type_=QUOTED) for text in found if len(text) <= LONGEST_TEMPLATE]

    return complete


def _message(client: HubClient, context: click.Context) -> Typedefs:
    return Typedefs.of_message(client, context.params["type_"])


def _request(client: HubClient, context: click.Context) -> Typedefs:
    service = client.resolve(context.params["service"])
    type_ = client.call("/rosapi/service_type", {"service": service})["type"]
    return Typedefs.of_request(client, type_)


def _goal(client: HubClient, context: click.Context) -> Typedefs:
    type_ = _typed_type(context)
    if not type_:
        [action] = GraphSnapshot(client).actions_named(client.resolve(context.params["action"]))
        type_ = action["type"]
    return Typedefs.of_message(client, f"{type_}Goal")


def _typed_type(context: click.Context) -> str:
    """Return TYPE of ``action send ACTION TYPE``, or an empty text."""
    words: Sequence[str] = context.params.get("goal") or ()
    type_ = words[0].replace("/action/", "/", 1) if len(words) == 1 else ""
    return type_ if is_type(type_) else ""


message = template(_message)
"""The message of ``topic pub``, when its type is typed."""
request = template(_request)
"""The request of ``service call``."""
goal = template(_goal)
"""The goal of ``action send``."""


def _one_line(value: object) -> str:
    """Return a message as YAML in one line."""
    import yaml  # 20 ms

    text: str = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=10**9)
    return text.rstrip("\n")


def _asked(ask: Callable[[HubClient], Found], hub: str | None) -> Found:
    found: Found = {}

    def answer() -> None:
        try:
            with HubClient("completion", hub) as client:
                found.update(ask(client))
        except (FibwsError, KeyError, TypeError, ValueError):
            pass  # There is no hub, or it is another kind of server.

    # Looking up a host's name has no timeout, but waiting for a thread has.
    thread = Thread(target=answer, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return dict(found)


def _items(found: Found, incomplete: str) -> list[CompletionItem]:
    """Return the names that begin so; relative ones if the typed one is relative."""
    relative = incomplete != "" and not incomplete.startswith("/")
    base = _namespace().rstrip("/") + "/" if relative else ""
    return [
        _item(name.removeprefix(base), type_ if is_type(type_) else "")
        for name, type_ in sorted(found.items())
        if name.startswith(base + incomplete) and _is_name(name)
    ]


def _item(name: str, help_: str = "", type_: str = "plain") -> CompletionItem:
    from click.shell_completion import CompletionItem  # Only completion needs it.

    return CompletionItem(name, help=help_ or None, type=type_)


def _namespace() -> str:
    try:
        return names.check_namespace(os.environ.get("ROS_NAMESPACE", "/"))
    except InvalidName:
        return "/"


def _is_name(name: str) -> bool:
    """Return whether a name is legal: a hub must not pass ``$(...)`` to the shell."""
    try:
        names.check(name)
    except InvalidName:
        return False
    return name.startswith("/")


def _beginning(found: Iterable[str], incomplete: str) -> list[CompletionItem]:
    return [_item(name) for name in sorted(found) if name.startswith(incomplete)]


def _types(kind: str) -> set[str]:
    """Return the names of types, from the names of their files."""
    folders = [STANDARD, *map(Path, named_folders())]
    return {name for folder in folders for name in _types_in(folder, kind)}


def _types_in(folder: Path, kind: str) -> Iterable[str]:
    """Yield the types in a folder of packages, or in a package."""
    for path in (*folder.glob(f"*/{kind}/*.{kind}"), *folder.glob(f"{kind}/*.{kind}")):
        name = f"{path.absolute().parts[-3]}/{path.stem}"
        if is_type(name):
            yield name
