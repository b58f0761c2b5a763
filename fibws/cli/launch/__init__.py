"""``fibws launch``: start nodes from launch files, as roslaunch does."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from fibws import hub_address, names
from fibws.cli import output
from fibws.cli.common_options import SETTINGS, examples, hub_option
from fibws.cli.exit_handling import clean_exit, end_line
from fibws.cli.run import workspace_option
from fibws.credentials import Credentials
from fibws.errors import FibwsError
from fibws.suggestions import suggestion

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.launch.model import Launch, LaunchNode
    from fibws.ros1.workspace.packages import Packages

_SECONDS = click.FloatRange(min=0, min_open=True)


def _complete(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete a package, then its launch files, then their arguments; or else paths."""
    from click.shell_completion import CompletionItem

    from fibws.cli.launch import sources

    found = sources.completions(list(context.params.get("words") or ()), incomplete)
    if found:
        return [CompletionItem(each) for each in found]
    return [CompletionItem(incomplete, type="file")]


@click.command(context_settings=SETTINGS)
@click.argument(
    "words", nargs=-1, metavar="[PACKAGE] FILE... [ARG:=VALUE]...", shell_complete=_complete
)
@click.option("--screen", "show", flag_value="screen", help="Show the output of all nodes.")
@click.option("--log", "show", flag_value="log", help="Only log the output of all nodes.")
@click.option("--required", is_flag=True, help="Stop all nodes when any node ends.")
@click.option("--wait", is_flag=True, help="Wait for a hub instead of starting one.")
@click.option(
    "-p",
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    help="The hub's port on this machine; a hub is started there if none is running.",
)
@hub_option
@workspace_option
@click.option("--nodes", "listing", flag_value="nodes", help="List the names of the nodes.")
@click.option("--find-node", "--find", metavar="NODE", help="Print the file that contains NODE.")
@click.option("--args", "args_of", metavar="NODE", help="Print the command line of NODE.")
@click.option("--ros-args", "listing", flag_value="arguments", help="List the files' arguments.")
@click.option("--files", "listing", flag_value="files", help="List files, with included ones.")
@click.option("--dump-params", "listing", flag_value="parameters", help="Print the parameters.")
@click.option("--check", "listing", flag_value="check", help="Check that nodes can be started.")
@click.option("-v", "--verbose", is_flag=True, help="Print files and parameters as they are read.")
@click.option("--no-summary", is_flag=True, help="Do not print the summary.")
@click.option(
    "--pid", metavar="FILE", type=click.Path(path_type=Path), help="Write the process ID to FILE."
)
@click.option(
    "--sigint-timeout",
    metavar="SECONDS",
    type=_SECONDS,
    default=15.0,
    show_default=True,
    help="Seconds to wait after SIGINT before sending SIGTERM.",
)
@click.option(
    "--sigterm-timeout",
    metavar="SECONDS",
    type=_SECONDS,
    default=2.0,
    show_default=True,
    help="Seconds to wait after SIGTERM before sending SIGKILL.",
)
@click.option("--skip-log-check", "--disable-title", "--local", is_flag=True, hidden=True)
@click.option("-w", "--numworkers", "-t", "--timeout", hidden=True)
@examples(
    "{launch} fibonacci fibonacci.launch", "{launch} some/folder/robot.launch speed:=2 --screen"
)
def command(words: tuple[str, ...], listing: str | None, **options: Any) -> None:
    """Start nodes from launch files, as roslaunch does.

    FILE is a launch file in PACKAGE, or a path; - reads standard input. ARG:=VALUE sets an <arg>.
    A hub is started if none is running. Ctrl-C stops all nodes; another Ctrl-C does not wait for
    them. The exit code is 1 if a node failed.
    """
    with clean_exit(endless=True):
        sys.exit(_main(words, listing, options))


def _main(words: Sequence[str], listing: str | None, options: dict[str, Any]) -> int:
    from fibws.cli.launch.sources import Sources
    from fibws.ros1.launch.model import CORE_PARAMETERS, argument_lines, summary

    sources = Sources(words, options["workspace"])
    if listing == "arguments":
        return _print(argument_lines(sources.read_arguments().launch.arguments.values()))
    reader = sources.read()
    launch = reader.launch
    for text in [*launch.warnings, *reader.unknown_values()]:
        click.echo(output.visible(f"WARNING: {text}"), err=True)
    url = _url(options)
    if options["find_node"]:
        return _print([_node(launch, options["find_node"]).file])
    if options["args_of"]:
        return _print([_command_line(_node(launch, options["args_of"]), sources.packages, url)])
    if listing is not None:
        return _list(listing, launch, sources.packages, url)
    launch.parameters = {**CORE_PARAMETERS, **launch.parameters}
    if options["required"]:
        for name, node in launch.nodes.items():
            launch.nodes[name] = replace(node, required=True, respawn=False)
    if options["verbose"]:
        _print(f"... loading XML file [{file}]" for file in launch.files)
        _print(f"Added parameter [{name}]" for name in launch.parameters)
    if not options["no_summary"]:
        _print(summary(launch))
    return _run(launch, sources.packages, url, options)


def _list(listing: str, launch: Launch, packages: Packages, url: str) -> int:
    """Print what there is of a kind, in place of starting it."""
    match listing:
        case "nodes":
            return _print(launch.nodes)
        case "files":
            return _print(os.path.abspath(file) for file in dict.fromkeys(launch.files))
        case "parameters":
            from fibws.values.parameter_files import dumped

            return _print([dumped(launch.parameters)])
        case "check":
            return _check(launch, packages, url)
    raise AssertionError(listing)


def _run(launch: Launch, packages: Packages, url: str, options: dict[str, Any]) -> int:
    from fibws.ros1.launch.session import LaunchConsole, Options, run

    file: Path | None = options["pid"]
    if file is not None:
        file.write_text(f"{os.getpid()}")
    try:
        return run(
            launch,
            packages,
            url,
            Options(
                output=options["show"],
                wait=options["wait"],
                has_default_url=_has_default_url(options),
                shares_terminal=True,
                sigint_timeout=options["sigint_timeout"],
                sigterm_timeout=options["sigterm_timeout"],
            ),
            LaunchConsole(output.line_as_is, output.has_colours(), end_line),
        )
    finally:
        if file is not None:
            file.unlink(missing_ok=True)


def _url(options: dict[str, Any]) -> str:
    """Return the hub's URL."""
    port, hub = options["port"], options["hub"]
    if port is not None:
        if hub is not None:
            raise click.UsageError("--port and --hub exclude each other.")
        return f"ws://127.0.0.1:{port}"
    url = hub_address.hub_url(hub)
    # The nodes need the token, too, and the URL without it.
    Credentials.find(hub).set_in(os.environ)
    return url


def _has_default_url(options: dict[str, Any]) -> bool:
    """Return whether neither an option nor $FIBWS_HUB chooses the hub's URL."""
    is_chosen = options["port"] is not None or options["hub"] is not None
    return not is_chosen and not os.environ.get(hub_address.ENVIRONMENT)


def _node(launch: Launch, name: str) -> LaunchNode:
    wanted = names.resolve(name)
    if wanted not in launch.nodes:
        known = "".join(f"\n * {each}" for each in launch.nodes)
        near = suggestion(wanted, launch.nodes) or "."
        raise click.ClickException(f"Cannot find node {wanted}{near} Known nodes:{known}")
    return launch.nodes[wanted]


def _command_line(node: LaunchNode, packages: Packages, url: str) -> str:
    from fibws.ros1.launch.node_command import node_command, node_variables, shell_line

    command = node_command(node, packages, url, os.environ).command
    return shell_line(node_variables(node, url, os.environ), command)


def _check(launch: Launch, packages: Packages, url: str) -> int:
    """Print why nodes cannot be started; return 1 if there are such nodes."""
    from fibws.ros1.launch.node_command import is_built_in, node_command
    from fibws.ros1.launch.rosbridge import rosbridges

    errors = []
    try:
        list(rosbridges(launch, packages))
    except FibwsError as error:
        errors.append(str(error))
    for node in launch.nodes.values():
        try:
            if not is_built_in(node, packages):
                node_command(node, packages, url, os.environ)
        except FibwsError as error:
            errors.append(str(error))
    files = output.counted(len(launch.files), "file")
    nodes = output.counted(len(launch.nodes), "node")
    _print(errors or [f"{files}, {nodes}: no problems found"])
    return 1 if errors else 0


def _print(lines: Iterable[str]) -> int:
    for line in lines:
        output.line(line)
    return 0
