"""``fibws param``: parameters, as rosparam reads and writes them."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from fibws import names
from fibws.cli import arguments, completers, output
from fibws.cli.common_options import json_option, with_hub
from fibws.client.hub_client import HubClient
from fibws.client.parameters import ROOT, HubParameters
from fibws.errors import FibwsError, ParameterNotSet
from fibws.files import replace_file
from fibws.suggestions import suggestion
from fibws.values import parameter_files

_name = click.argument("name", shell_complete=completers.params)
_namespace = click.argument("namespace", default=ROOT, shell_complete=completers.params)
_verbose = click.option("-v", "--verbose", is_flag=True, help="Print each change.")


@click.group()
def command() -> None:
    """Get and set parameters, load and dump them.

    Values are YAML: 1 is a number, '"1"' a string. The value of a namespace is an object.
    """


@command.command("list")
@_namespace
@json_option
@with_hub("param")
def list_(client: HubClient, namespace: str, as_json: bool) -> None:
    """List the parameters, or those in NAMESPACE."""
    above = _global(client, namespace).rstrip("/") + "/"
    output.names((name for name in _names(client) if name.startswith(above)), json_=as_json)


@command.command()
@_name
@click.option(
    "-p", "--pretty", is_flag=True, help="Print strings without quotes; this is not always YAML."
)
@json_option
@with_hub("param")
def get(client: HubClient, name: str, pretty: bool, as_json: bool) -> None:
    """Print the value of the parameter or namespace NAME."""
    value = _get(client, _global(client, name))
    if as_json:
        output.as_json(value)
    elif pretty:
        for line in parameter_files.pretty(value):
            output.line(line)
    else:
        output.line(parameter_files.text(value))


@command.command("set", context_settings=arguments.VALUES)
@_name
@click.argument("value", required=False, callback=arguments.check)
@click.option(
    "-t",
    "--textfile",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    metavar="FILE",
    help="Set the parameter to the text of FILE.",
)
@_verbose
@with_hub("param")
def set_(
    client: HubClient, name: str, value: str | None, textfile: Path | None, verbose: bool
) -> None:
    """Set the parameter NAME to VALUE.

    An object sets a parameter for each key and keeps others: param set /robot "{size: 3}" sets
    only /robot/size.
    """
    if (value is None) == (textfile is None):
        raise click.UsageError("Expected either VALUE or -t FILE.")
    if textfile is not None:
        new: Any = parameter_files.read(textfile)
    else:
        # '' is the empty string, as in rosparam, rather than null.
        new = parameter_files.parse(value) if value else ""
    _set(client, parameter_files.leaves(_global(client, name), new), verbose=verbose)


@command.command()
@_name
@_verbose
@with_hub("param")
def delete(client: HubClient, name: str, verbose: bool) -> None:
    """Delete the parameter or namespace NAME.

    / deletes all parameters.
    """
    name = _global(client, name)
    try:
        HubParameters(client.call).delete(name)
    except ParameterNotSet:
        raise _not_set(client, name) from None
    if verbose:
        output.line(f"deleted parameter [{name}]")


@command.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, allow_dash=True))
@_namespace
@_verbose
@with_hub("param")
def load(client: HubClient, file: str, namespace: str, verbose: bool) -> None:
    """Set the parameters in the YAML file FILE.

    If FILE is -, read standard input. Names are relative to NAMESPACE. Angles may be written
    deg(180) or rad(pi/2). If FILE is invalid, nothing is set.
    """
    text = _piped() if file == "-" else parameter_files.read(Path(file))
    try:
        found = parameter_files.parameters(text, _global(client, namespace))
    except FibwsError as error:
        source = "standard input" if file == "-" else file
        raise click.ClickException(f"{source}: {error}") from None
    _set(client, found, verbose=verbose)


@command.command()
@click.argument("file", required=False, type=click.Path(dir_okay=False, allow_dash=True))
@_namespace
@json_option
@_verbose
@with_hub("param")
def dump(client: HubClient, file: str | None, namespace: str, as_json: bool, verbose: bool) -> None:
    """Write the parameters, or those in NAMESPACE, to FILE.

    FILE is YAML that load reads. If FILE is missing or -, print the parameters.
    """
    value = _get(client, _global(client, namespace))
    if file is None or file == "-":
        output.as_json(value) if as_json else output.line(_saved(value).removesuffix("\n"))
        return
    text = json.dumps(value, ensure_ascii=False) + "\n" if as_json else _saved(value)
    path = Path(file)
    try:
        if path.exists() and not path.is_file():  # Such as /dev/stdout.
            path.write_text(text, "utf-8")
        else:
            replace_file(path, text.encode(), keep=True)
    except OSError as error:
        raise click.ClickException(f"Cannot write {file}: {error.strerror}") from None
    if verbose:
        output.line(f"dumped namespace [{_global(client, namespace)}] to file [{file}]")


def _saved(value: Any) -> str:
    return parameter_files.saved(parameter_files.native(value))


def _global(client: HubClient, name: str) -> str:
    """Return the global name of a parameter, which may contain any characters, as in ROS."""
    if name.startswith("~"):
        raise click.UsageError(f"{name}: write private parameters as /NODE/{name[1:]}")
    name = name.rstrip("/")
    return name if name.startswith("/") else names.join(client.namespace, name).rstrip("/") or ROOT


def _piped() -> str:
    if sys.stdin is None:
        raise click.UsageError("FILE is -, but standard input is closed.")
    return sys.stdin.read()


def _names(client: HubClient) -> list[str]:
    return HubParameters(client.call).names()


def _get(client: HubClient, name: str) -> Any:
    try:
        return HubParameters(client.call).get(name)
    except ParameterNotSet:
        raise _not_set(client, name) from None


def _set(client: HubClient, leaves: list[tuple[str, str]], *, verbose: bool) -> None:
    parameters = HubParameters(client.call)
    for name, value in leaves:
        parameters.set_json(name, value)
        if verbose:
            output.line(f"set parameter [{name}] to [{value}]")


def _not_set(client: HubClient, name: str) -> click.ClickException:
    return click.ClickException(f"Parameter [{name}] is not set{suggestion(name, _names(client))}")
