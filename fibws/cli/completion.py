"""``fibws completion``: the scripts that shells source; `completers` finds the names."""

from __future__ import annotations

import click
from click.shell_completion import get_completion_class

PROGRAM = "fibws"
VARIABLE = "_FIBWS_COMPLETE"
"""The variable with which a shell requests completions; click derives it from the name."""
SHELLS = ("bash", "fish", "zsh")


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print the script that enables completion by TAB in SHELL.

    Commands, options and the names of topics, nodes, services, actions, parameters and types are
    completed. Names come from the hub at --hub or $FIBWS_HUB.

    To enable it in this shell; in every new shell by a line in the named file:

    \b
      bash   eval "$(fibws completion bash)"      ~/.bashrc
      zsh    eval "$(fibws completion zsh)"       ~/.zshrc, after compinit
      fish   fibws completion fish | source       ~/.config/fish/config.fish
    """
    kind = get_completion_class(shell)
    assert kind is not None, "click supports them all"
    click.echo(kind(context.find_root().command, {}, PROGRAM, VARIABLE).source())
