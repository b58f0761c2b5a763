"""Exit codes and one-line errors: signals, a closed pipe (``| head``), errors of fibws."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

from fibws.cli.output import visible
from fibws.errors import AccessDenied, FibwsError, HubLimitReached, InvalidValue
from fibws.exit_signals import exit_signals

INTERRUPTED = 130
"""The exit code after Ctrl-C, as in shells: 128 + SIGINT."""


class _AccessDenied(click.ClickException):
    exit_code = 77  # EX_NOPERM of sysexits.h


class _HubLimitReached(click.ClickException):
    exit_code = 75  # EX_TEMPFAIL of sysexits.h


@contextmanager
def clean_exit(*, endless: bool = False) -> Iterator[None]:
    """Turn the exceptions that end a command into exit codes and one-line errors.

    Args:
        endless: whether Ctrl-C is the command's normal end, with exit code 0.

    Raises:
        ClickException: the command failed; click prints the text in one line and exits with 1, with
            2 for an invalid value, with 77 if the hub refuses the client, or with 75 if it has no
            room for it.
    """
    try:
        yield
    except (KeyboardInterrupt, click.Abort):  # click.Abort: Ctrl-C at a prompt.
        end_line()
        sys.exit(0 if endless else INTERRUPTED)
    except BrokenPipeError:
        _discard_output()
    except InvalidValue as error:
        raise click.UsageError(visible(str(error))) from None
    except HubLimitReached as error:
        raise _HubLimitReached(visible(str(error))) from None
    except AccessDenied as error:
        raise _AccessDenied(visible(str(error))) from None
    except FibwsError as error:
        # The text may contain control characters of another program.
        raise click.ClickException(visible(str(error))) from None
    except OSError as error:
        if error.filename is None:  # Most likely the output's disk is full.
            _discard_output()
        where = f"{error.filename}: " if error.filename is not None else ""
        raise click.ClickException(visible(f"{where}{error.strerror or error}")) from None


@contextmanager
def exit_on_signals() -> Iterator[None]:
    """Raise SystemExit at SIGTERM and SIGHUP, so that what the block has begun is undone."""

    def exit_(number: int, frame: object) -> None:
        raise SystemExit(128 + number)  # As shells report it.

    earlier = {each: signal.signal(each, exit_) for each in exit_signals() if each != signal.SIGINT}
    try:
        yield
    finally:
        for number, handler in earlier.items():
            signal.signal(number, handler)


def end_line() -> None:
    """End the terminal's line that shows ^C, so that the shell's prompt begins a new line."""
    if sys.stderr is not None and sys.stderr.isatty():
        click.echo(err=True)


def _discard_output() -> None:
    # Python flushes standard output again when it exits, which must not fail.
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
