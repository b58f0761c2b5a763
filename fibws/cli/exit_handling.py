"""How a command ends: by Ctrl-C, by a reader who leaves (``| head``), by an error in one line."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

from fibws.cli.output import visible
from fibws.errors import FibwsError, InvalidValue

INTERRUPTED = 130
"""The exit code of what Ctrl-C broke off, as shells have it: 128 + SIGINT."""


@contextmanager
def ending(*, endless: bool = False) -> Iterator[None]:
    """Make an end of what runs within.

    Args:
        endless: whether Ctrl-C is how it ends, which is no failure then.

    Raises:
        ClickException: something went wrong; click prints what in one line and exits with 1.
    """
    try:
        yield
    except (KeyboardInterrupt, click.Abort):  # The latter is Ctrl-C at a question.
        end_line()
        sys.exit(0 if endless else INTERRUPTED)
    except BrokenPipeError:
        _print_no_more()
    except InvalidValue as error:
        raise click.UsageError(visible(str(error))) from None
    except FibwsError as error:
        # It may hold a provider's own words.
        raise click.ClickException(visible(str(error))) from None
    except OSError as error:
        # A full disk, most likely, that what is printed goes to.
        _print_no_more()
        where = f"{error.filename}: " if error.filename is not None else ""
        raise click.ClickException(visible(f"{where}{error.strerror or error}")) from None


def end_line() -> None:
    """End the line that a terminal has shown ^C in: the shell's prompt must not stand behind it."""
    if sys.stderr is not None and sys.stderr.isatty():
        click.echo(err=True)


def _print_no_more() -> None:
    # Python flushes standard output once more when it exits, and must not fail at that.
    if sys.stdout is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
