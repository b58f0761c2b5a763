"""``fibws service``: list, inspect and call services."""

from __future__ import annotations

from collections.abc import Iterator

import click

from fibws.cli import arguments, completers, output
from fibws.cli.arguments import piped_input
from fibws.cli.common_options import examples, json_option, with_hub
from fibws.client.graph_snapshot import Entry, GraphSnapshot, in_namespace
from fibws.client.hub_client import HubClient
from fibws.command_names import called_alias
from fibws.suggestions import suggestion
from fibws.values import parsing
from fibws.values.typedefs import TIMES, Typedefs, if_known
from fibws.values.yaml_text import message_text

POLL = 0.1
"""Seconds between two checks whether a service is available."""

LOGGER_SERVICES = ("/get_loggers", "/set_logger_level")
"""The ends of the names of the services that each node has."""

_service = click.argument("service", shell_complete=completers.services)


@click.group()
def command() -> None:
    """List, inspect and call services."""


@command.command("list")
@click.argument("namespace", required=False, shell_complete=completers.services)
@click.option("-n", "--nodes", is_flag=True, help="Show the node of each service.")
@click.option(
    "-a",
    "--all",
    "everything",
    is_flag=True,
    help="List the logger services of each node, too (~get_loggers, ~set_logger_level).",
)
@json_option
@with_hub("service")
def list_(
    client: HubClient, namespace: str | None, nodes: bool, everything: bool, as_json: bool
) -> None:
    """List the services, or those in NAMESPACE."""
    # rosservice has no --all: it lists them always.
    everything = everything or called_alias() == "rosservice"
    services = GraphSnapshot(client).services
    for service in in_namespace(namespace and client.resolve_namespace(namespace), services):
        if not everything and service["name"].endswith(LOGGER_SERVICES):
            continue
        if as_json:
            output.as_json(service)
        else:
            output.line(f"{service['name']} {service['node']}" if nodes else service["name"])


@command.command()
@_service
@json_option
@with_hub("service")
def info(client: HubClient, service: str, as_json: bool) -> None:
    """Show the node, its address, the type and the arguments of SERVICE."""
    snapshot = GraphSnapshot(client)
    found = snapshot.service(client.resolve(service))
    address, arguments = snapshot.address(found["node"]), _arguments(client, found)
    if as_json:
        output.as_json({**found, "address": address, "args": arguments})
        return
    output.line(f"Node: {found['node']}")
    output.line(f"Address: {address}")
    output.line(f"Type: {found['type']}")
    output.line(f"Args: {' '.join(arguments)}")


@command.command("type")
@_service
@with_hub("service")
def type_(client: HubClient, service: str) -> None:
    """Print the type of SERVICE."""
    output.line(_found(client, service)["type"])


@command.command()
@_service
@with_hub("service")
def node(client: HubClient, service: str) -> None:
    """Print the node of SERVICE."""
    output.line(_found(client, service)["node"])


@command.command()
@_service
@with_hub("service")
def args(client: HubClient, service: str) -> None:
    """Print the names of the arguments of SERVICE."""
    output.line(" ".join(_arguments(client, _found(client, service))))


@command.command()
@click.argument("type_", metavar="TYPE", shell_complete=completers.service_types)
@json_option
@with_hub("service")
def find(client: HubClient, type_: str, as_json: bool) -> None:
    """List the services of TYPE, such as std_srvs/SetBool."""
    wanted = type_.replace("/srv/", "/", 1)
    services = GraphSnapshot(client).services
    output.names((each["name"] for each in services if each["type"] == wanted), json_=as_json)


@command.command(context_settings=arguments.VALUES)
@_service
@click.argument(
    "arguments",
    nargs=-1,
    metavar="[ARGS]...",
    callback=arguments.check,
    shell_complete=completers.request,
)
@click.option("-v", "--verbose", is_flag=True, help="Print the request, too.")
@click.option("--wait", is_flag=True, help="Wait until the service is available.")
@click.option(
    "--timeout",
    type=click.FloatRange(0, min_open=True),
    metavar="SECONDS",
    help="Maximum time until the response.  [default: the hub's setting, or 60]",
)
@json_option
@with_hub("service")
@examples("{service call} /add_two_ints 3 4", '{service call} /add_two_ints "{a: 3, b: 4}"')
def call(
    client: HubClient,
    service: str,
    arguments: tuple[str, ...],
    verbose: bool,
    wait: bool,
    timeout: float | None,
    as_json: bool,
) -> None:
    """Call SERVICE and print its response.

    ARGS are YAML: a value for each field in order, 3 4, or one object, "{a: 3, b: 4}". Without
    ARGS, read YAML documents from standard input, and call the service for each.
    """
    name = client.resolve(service)
    if wait:
        _wait(client, name)
    found = _available(client, name)
    typedefs = if_known(Typedefs.of_request, client, found["type"])
    response_typedefs = if_known(Typedefs.of_response, client, found["type"])
    for request in _requests(arguments, typedefs):
        if verbose and not as_json:
            output.line(message_text(request, typedefs))
            output.line("---")
        response = client.call(name, request, timeout or 0)
        if as_json:
            output.as_json(response)
        else:
            output.line(message_text(response, response_typedefs))


def _found(client: HubClient, service: str) -> Entry:
    return GraphSnapshot(client).service(client.resolve(service))


def _available(client: HubClient, name: str) -> Entry:
    services = {each["name"]: each for each in GraphSnapshot(client).services}
    if name not in services:
        nearest = suggestion(name, services) or "."
        raise click.ClickException(f"Service [{name}] is not available{nearest}")
    return services[name]


def _wait(client: HubClient, name: str) -> None:
    while not client.call("/rosapi/service_type", {"service": name})["type"]:
        client.process(POLL)


def _arguments(client: HubClient, service: Entry) -> list[str]:
    """Return the names of the request's fields; those of nested ones as ``header.seq``."""
    typedefs = if_known(Typedefs.of_request, client, service["type"])
    return list(_field_names(typedefs, typedefs.root, ""))


def _field_names(typedefs: Typedefs, type_: str, prefix: str) -> Iterator[str]:
    for field in typedefs.fields(type_) if type_ in typedefs else ():
        if field.length is None and field.type in typedefs and field.type not in TIMES:
            yield from _field_names(typedefs, field.type, f"{prefix}{field.name}.")
        else:
            yield f"{prefix}{field.name}"


def _requests(arguments: tuple[str, ...], typedefs: Typedefs) -> Iterator[Entry]:
    has_no_fields = typedefs.root in typedefs and not typedefs.fields(typedefs.root)
    if arguments or has_no_fields:
        yield parsing.message(arguments, typedefs)
        return
    stream = piped_input()
    is_empty = True
    documents = parsing.documents(stream) if stream is not None else ()
    for request in parsing.messages(documents, typedefs):
        is_empty = False
        yield request
    if is_empty:
        fields = " ".join(_field_names(typedefs, typedefs.root, ""))
        raise click.UsageError(f"Please specify service arguments: {fields}")
