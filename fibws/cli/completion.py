"""``fibws completion``: the scripts that shells source; `completers` finds the names."""

from __future__ import annotations

import re
from typing import Any

import click
from click.shell_completion import (
    BashComplete,
    CompletionItem,
    FishComplete,
    ZshComplete,
    add_completion_class,
    get_completion_class,
)

from fibws.cli.completers import QUOTED

PROGRAM = "fibws"
VARIABLE = "_FIBWS_COMPLETE"
"""The variable with which a shell requests completions; click derives it from the name."""
SHELLS = ("bash", "fish", "zsh")


def _quoted(text: str) -> str:
    """Return a text in double quotes, in which a person can edit it."""
    return '"{}"'.format(re.sub(r'(["\\\\$`])', r"\\\1", text))


class _Bash(BashComplete):
    # Brackets in a completion are not a pattern: with nullglob, bash would drop it.
    source_template = BashComplete.source_template.replace(
        "local IFS=$'\\n'\n", "local - IFS=$'\\n'\n    set -f\n"
    )

    def format_completion(self, item: CompletionItem[Any]) -> str:
        if item.type == QUOTED:
            return f"plain,{_quoted(item.value)}"
        return super().format_completion(item)


class _Zsh(ZshComplete):
    # With -Q, zsh inserts a completion as it is.
    source_template = ZshComplete.source_template.replace(
        'if [[ "$type" == "plain" ]]; then',
        f'if [[ "$type" == "{QUOTED}" ]]; then\n'
        '            compadd -Q -U -V unsorted -- "$key"\n'
        '        elif [[ "$type" == "plain" ]]; then',
    )

    def format_completion(self, item: CompletionItem[Any]) -> str:
        if item.type == QUOTED:
            return f"{QUOTED}\n{_quoted(item.value)}\n_"
        return super().format_completion(item)


class _Fish(FishComplete):
    # Only the first comma is a separator. fish quotes what it inserts.
    source_template = FishComplete.source_template.replace(
        'string split "," $completion', 'string split -m 1 "," $completion'
    )

    def format_completion(self, item: CompletionItem[Any]) -> str:
        return f"plain,{item.value}" if item.type == QUOTED else super().format_completion(item)


for _class in (_Bash, _Zsh, _Fish):
    add_completion_class(_class)


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print the script that enables completion by TAB in SHELL.

    Commands, options and the names of topics, nodes, services, actions, parameters and types are
    completed; for a message, a request or a goal, TAB inserts one to be edited. Names and types
    come from the hub at --hub or $FIBWS_HUB.

    To enable it in this shell; in every new shell by a line in the named file:

    \b
      bash   eval "$(fibws completion bash)"      ~/.bashrc
      zsh    eval "$(fibws completion zsh)"       ~/.zshrc, after compinit
      fish   fibws completion fish | source       ~/.config/fish/config.fish
    """
    kind = get_completion_class(shell)
    assert kind is not None, "click supports them all"
    click.echo(kind(context.find_root().command, {}, PROGRAM, VARIABLE).source())
