"""``fibws completion``: what makes a shell complete commands, topics, nodes and the like."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

PROGRAM = "fibws"
VARIABLE = "_FIBWS_COMPLETE"
"""The variable by which a shell asks for completions; click makes it of the program's name."""
SHELLS = ("bash", "fish", "zsh")


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print what makes a shell complete what you type, by TAB.

    It completes commands, options, and the names of what there is: topics, nodes, services,
    actions, parameters and types. Names come from the hub that $FIBWS_HUB tells of, or --hub.

    To have it in this shell and, by a line in the file that is named, in each new one:

    \b
      bash   eval "$(fibws completion bash)"      ~/.bashrc
      zsh    eval "$(fibws completion zsh)"       ~/.zshrc, behind compinit
      fish   fibws completion fish | source       ~/.config/fish/config.fish
    """
    kind = get_completion_class(shell)
    assert kind is not None, "click knows them all"
    click.echo(kind(context.find_root().command, {}, PROGRAM, VARIABLE).source())
