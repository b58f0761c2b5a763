"""``fibws token``: the tokens with which clients enter a hub, in a file that the hub reads."""

from __future__ import annotations

import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click

from fibws.access.rights import RIGHTS, Principal, Right, Rights, check_glob
from fibws.access.token_file import TokenFile, Tokens
from fibws.cli import output
from fibws.cli.common_options import examples, json_option
from fibws.errors import AccessError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

HELP_OF_RIGHTS: dict[Right, str] = {
    "publish": "Topics that it {may} publish to",
    "subscribe": "Topics that it {may} subscribe to",
    "call": "Services and actions that it {may} call",
    "provide": "Services and actions that it {may} provide",
    "param_read": "Parameters that it {may} read",
    "param_write": "Parameters that it {may} set",
    "node": "Names that its nodes {may} have",
}
"""The help of the option of each right; the order is that of the options."""
UNITS = {"m": "minutes", "h": "hours", "d": "days", "w": "weeks"}
_TIME = re.compile(r"([0-9]{1,6})([mhdw])")


@click.group()
def command() -> None:
    """Create, list and revoke the tokens of a hub.

    A hub that is started with --tokens FILE lets in clients with a token of that file, and lets
    them do what the token's rights allow. FILE holds only digests of tokens. A running hub reads
    it again on SIGHUP.
    """


def _file_option(**details: Any) -> Callable[[Callable[..., None]], Callable[..., None]]:
    return click.option(
        "--file",
        metavar="FILE",
        envvar="FIBWS_TOKENS",
        required=True,
        is_eager=True,  # The completion of names needs it.
        type=click.Path(dir_okay=False, path_type=Path, **details),
        help="File of tokens; $FIBWS_TOKENS may name it instead.",
    )


def _check_globs(
    context: click.Context, parameter: click.Parameter, globs: tuple[str, ...]
) -> tuple[str, ...]:
    for glob in globs:
        try:
            check_glob(glob)
        except AccessError as error:
            raise click.BadParameter(str(error)) from None
    return globs


def _rights_options(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command an option for each right, and one for its exceptions."""
    for prefix, may in (("deny_", "may not"), ("", "may")):
        for right, text in reversed(HELP_OF_RIGHTS.items()):
            command = click.option(
                f"--{prefix}{right}".replace("_", "-"),
                metavar="GLOB",
                multiple=True,
                callback=_check_globs,
                help=f"{text.format(may=may)}; can be repeated.",
            )(command)
    return command


def _expiry(
    context: click.Context, parameter: click.Parameter, text: str | None
) -> datetime | None:
    """Return the time for 30d or 2027-01-31, which are UTC."""
    if text is None:
        return None
    now = datetime.now(UTC)
    try:
        if found := _TIME.fullmatch(text):
            return now + timedelta(**{UNITS[found[2]]: int(found[1])})
        time = datetime.fromisoformat(text)
    except (ValueError, OverflowError):
        text = f"expected a time such as 30d or 12h, or a date such as 2027-01-31, got {text!r}"
        raise click.BadParameter(text) from None
    time = time if time.tzinfo else time.replace(tzinfo=UTC)
    if time <= now:
        raise click.BadParameter(f"{text} is in the past")
    return time


@command.command()
@click.argument("name")
@_file_option()
@_rights_options
@click.option("--admin", is_flag=True, help="Allow everything, including to kill nodes.")
@click.option(
    "--expires",
    metavar="TIME",
    callback=_expiry,
    help="Time until it expires, such as 30d or 12h, or a date such as 2027-01-31 (UTC).",
)
@examples(
    "{token add} teleop --file tokens.toml --publish /cmd_vel --subscribe '/camera/**'",
    "{token add} dashboard --file tokens.toml --subscribe '/**' --param-read '/**'",
    "{token add} operator --file tokens.toml --admin --expires 30d",
)
def add(name: str, file: Path, admin: bool, expires: datetime | None, **options: Any) -> None:
    """Create a token for NAME, and print it.

    It is printed only now, on standard output; FILE has its digest. In a GLOB, * matches within one
    level of a name, ** matches any number of levels, and %n stands for NAME. A --deny option wins
    over the others.
    """
    allow = {right: globs for right in RIGHTS if (globs := options[right])}
    deny = {right: globs for right in RIGHTS if (globs := options[f"deny_{right}"])}
    if not allow and not admin:
        raise click.UsageError(
            "the token would allow nothing; give it rights, such as --subscribe '/**' or --admin"
        )
    rights = Rights(cast("dict[Right, tuple[str, ...]]", allow), deny, admin=admin, name=name)
    token = TokenFile(file).add(name, rights, expires)
    click.echo(
        f"Added {output.visible(name, keep='')} to {file}. Keep the token, it is not shown again:",
        err=True,
    )
    output.line(token)


@command.command("list")
@_file_option(exists=True)
@json_option
def list_(file: Path, as_json: bool) -> None:
    """List the names in FILE, with their rights.

    Tokens themselves cannot be shown.
    """
    tokens = Tokens.load(file)
    found = [("token", each) for each in tokens.tokens.values()]
    found += [("certificate", each) for each in tokens.certificates.values()]
    if tokens.anonymous is not None:
        found.append(("anonymous", tokens.anonymous))
    if as_json:
        for kind, each in found:
            expires = None if each.expires is None else _date(each.expires).isoformat()
            output.as_json(
                {"name": each.name, "kind": kind, "expires": expires, **each.rights.table()}
            )
        return
    rows = [
        (each.name, kind, _expiry_text(each), _rights_text(each.rights)) for kind, each in found
    ]
    output.table(("NAME", "KIND", "EXPIRES", "RIGHTS"), rows)


def _complete_names(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    from click.shell_completion import CompletionItem

    try:
        tokens = Tokens.load(context.params["file"])
    except (AccessError, KeyError, TypeError):
        return []
    names = [each.name for each in tokens.tokens.values()]
    return [CompletionItem(name) for name in names if name.startswith(incomplete)]


@command.command()
@click.argument("name", shell_complete=_complete_names)
@_file_option(exists=True)
def revoke(name: str, file: Path) -> None:
    """Remove the token of NAME from FILE.

    A running hub disconnects its clients as soon as it gets SIGHUP.
    """
    TokenFile(file).revoke(name)
    output.line(f"Revoked {name}. A running hub reads {file} again on SIGHUP.")


def _date(seconds: float) -> datetime:
    return datetime.fromtimestamp(seconds, UTC)


def _expiry_text(principal: Principal) -> str:
    if principal.expires is None:
        return "never"
    is_over = principal.is_expired(datetime.now(UTC).timestamp())
    return f"{_date(principal.expires):%Y-%m-%d %H:%M}{' (expired)' if is_over else ''}"


def _rights_text(rights: Rights) -> str:
    """Return rights as in ``publish /cmd_vel, subscribe /**, not subscribe /private/**``."""
    if rights.admin:
        return "admin"
    found = [
        f"{prefix}{right} {' '.join(globs[right])}"
        for prefix, globs in (("", rights.allow), ("not ", rights.deny))
        for right in RIGHTS
        if globs.get(right)
    ]
    return ", ".join(found) or "none"
