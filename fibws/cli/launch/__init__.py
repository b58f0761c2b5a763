"""``fibws launch``: run what launch files say, as roslaunch does."""

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
from fibws.cli.common_options import SETTINGS, hub_option
from fibws.cli.exit_handling import ending
from fibws.cli.run import workspace_option
from fibws.errors import FibwsError
from fibws.suggestions import suggestion

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from fibws.ros1.launch.model import Launch, Node
    from fibws.ros1.workspace.packages import Packages

_SECONDS = click.FloatRange(min=0, min_open=True)


def _complete(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """A package, then its launch files, then their arguments; at any time, a file."""
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
@click.option("--screen", "show", flag_value="screen", help="Show what all nodes print.")
@click.option("--log", "show", flag_value="log", help="Keep what all nodes print in files.")
@click.option("--required", is_flag=True, help="End all as soon as any node ends.")
@click.option("--wait", is_flag=True, help="Wait for a hub rather than start one.")
@click.option(
    "-p",
    "--port",
    metavar="PORT",
    type=click.IntRange(0, 65535),
    help="The hub's port on this machine, where it is started if it is not there.",
)
@hub_option
@workspace_option
@click.option("--nodes", "listing", flag_value="nodes", help="List the nodes' names.")
@click.option("--find-node", "--find", metavar="NODE", help="Tell which file a node is in.")
@click.option("--args", "args_of", metavar="NODE", help="Print the command that starts a node.")
@click.option("--ros-args", "listing", flag_value="arguments", help="List the files' arguments.")
@click.option("--files", "listing", flag_value="files", help="List the files that are read.")
@click.option("--dump-params", "listing", flag_value="parameters", help="Print the parameters.")
@click.option("--check", "listing", flag_value="check", help="Look for what cannot be started.")
@click.option("-v", "--verbose", is_flag=True, help="Say what is read.")
@click.option("--no-summary", is_flag=True, help="Do not say what is going to run.")
@click.option("--pid", metavar="FILE", type=click.Path(path_type=Path), help="Keep my id in FILE.")
@click.option(
    "--sigint-timeout",
    metavar="SECONDS",
    type=_SECONDS,
    default=15.0,
    show_default=True,
    help="The time that nodes have to end.",
)
@click.option(
    "--sigterm-timeout",
    metavar="SECONDS",
    type=_SECONDS,
    default=2.0,
    show_default=True,
    help="The time that they have when they are told so again.",
)
@click.option("--skip-log-check", "--disable-title", "--local", is_flag=True, hidden=True)
@click.option("-w", "--numworkers", "-t", "--timeout", hidden=True)
def command(words: tuple[str, ...], listing: str | None, **options: Any) -> None:
    """Run the nodes that launch files tell of, as roslaunch does.

    \b
      fibws launch fibonacci fibonacci.launch
      fibws launch some/folder/robot.launch speed:=2 --screen

    FILE is one of PACKAGE, wherever it is in there, or a path; - is what comes in by a pipe.
    ARG:=VALUE gives an <arg> of it a value. Unless there is a hub, one is started, too, and ended
    at the end. Ctrl-C ends all; again, at once. The exit code is 1 if something has failed.
    """
    with ending(endless=True):
        sys.exit(_main(words, listing, options))


def _main(words: Sequence[str], listing: str | None, options: dict[str, Any]) -> int:
    from fibws.cli.launch.sources import Sources
    from fibws.ros1.launch import listing as lines

    sources = Sources(words, options["workspace"])
    if listing == "arguments":
        return _print(lines.arguments(sources.read_arguments().launch.arguments.values()))
    reader = sources.read()
    launch = reader.launch
    for text in [*launch.warnings, *reader.unknown_values()]:
        click.echo(output.visible(f"WARNING: {text}"), err=True)
    url = _url(options)
    if options["find_node"]:
        return _print([_node(launch, options["find_node"]).file])
    if options["args_of"]:
        return _print([_typed(_node(launch, options["args_of"]), sources.packages, url)])
    match listing:
        case "nodes":
            return _print(launch.nodes)
        case "files":
            return _print(os.path.abspath(file) for file in dict.fromkeys(launch.files))
        case "parameters":
            from fibws.values.parameter_files import dumped

            return _print([dumped(launch.parameters)])
        case "check":
            return _check(launch, sources.packages, url)
    if options["required"]:
        for name, node in launch.nodes.items():
            launch.nodes[name] = replace(node, required=True, respawn=False)
    if options["verbose"]:
        _print(f"... loading XML file [{file}]" for file in launch.files)
        _print(f"Added parameter [{name}]" for name in launch.parameters)
    if not options["no_summary"]:
        _print(lines.summary(launch))
    return _run(launch, sources.packages, url, options)


def _run(launch: Launch, packages: Packages, url: str, options: dict[str, Any]) -> int:
    from fibws.cli.launch.run import Options, run

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
                wait_interrupt=options["sigint_timeout"],
                wait_terminate=options["sigterm_timeout"],
            ),
        )
    finally:
        if file is not None:
            file.unlink(missing_ok=True)


def _url(options: dict[str, Any]) -> str:
    """Where the hub is, or is to be."""
    port, hub = options["port"], options["hub"]
    if port is not None:
        if hub is not None:
            raise click.UsageError("Give the hub's --port on this machine, or its --hub URL.")
        return f"ws://127.0.0.1:{port}"
    return hub_address.hub_url(hub)


def _node(launch: Launch, name: str) -> Node:
    wanted = names.resolve(name)
    if wanted not in launch.nodes:
        known = "".join(f"\n * {each}" for each in launch.nodes)
        raise click.ClickException(
            f"Cannot find node {wanted}{suggestion(wanted, launch.nodes) or '.'} There are:{known}"
        )
    return launch.nodes[wanted]


def _typed(node: Node, packages: Packages, url: str) -> str:
    from fibws.ros1.launch import command

    start = command.start_of(node, packages, url, os.environ)
    return command.shown(command.variables_of(node, url, os.environ), start.command)


def _check(launch: Launch, packages: Packages, url: str) -> int:
    """Say what keeps nodes from being started; the exit code is 1 if anything does."""
    from fibws.ros1.launch import command

    faults = []
    for node in launch.nodes.values():
        try:
            if not command.hub_does_it(node, packages):
                command.start_of(node, packages, url, os.environ)
        except FibwsError as error:
            faults.append(str(error))
    files = output.counted(len(launch.files), "file")
    told = f"{files}, {output.counted(len(launch.nodes), 'node')}: nothing is wrong"
    _print(faults or [told])
    return 1 if faults else 0


def _print(lines: Iterable[str]) -> int:
    for line in lines:
        output.line(line)
    return 0
