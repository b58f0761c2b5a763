"""``fibws bag compress``, ``decompress`` and ``reindex``: they write bags anew."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import click

from fibws.bags import open_reader, open_writer, reindex
from fibws.bags.files import is_mcap
from fibws.bags.mcap_files import rewrite_mcap
from fibws.bags.rosbag2 import listed
from fibws.bags.sqlite_files import SUFFIX as SQLITE_SUFFIX
from fibws.cli import output
from fibws.cli.bag.filtering import Copy
from fibws.cli.bag.progress import Progress
from fibws.cli.common_options import examples
from fibws.cli.exit_handling import clean_exit, exit_on_signals
from fibws.command_names import command_name
from fibws.errors import BagError
from fibws.files import replacing

Rewrite: TypeAlias = Callable[[Path, Path, Progress], None]
"""Writes a new bag, the second path, of one, and shows its progress."""
MOST_NAMES = 5
"""Files of a folder that are named in an error."""


def _options(function: Callable[..., None]) -> Callable[..., None]:
    """Give a command its bags, and the options that all commands here have."""
    for option in (
        click.option("-q", "--quiet", is_flag=True, help="Do not show the progress."),
        click.option(
            "-f", "--force", is_flag=True, help="Overwrite the copies of the originals, *.orig.bag."
        ),
        click.option(
            "--output-dir",
            metavar="DIR",
            type=click.Path(file_okay=False, path_type=Path),
            help="Write the new bags to DIR, which is created if it is missing, instead of "
            "replacing the originals.",
        ),
        click.argument(
            "bags", metavar="BAG...", nargs=-1, required=True, type=click.Path(path_type=Path)
        ),
    ):
        function = option(function)
    return function


@click.command()
@_options
@click.option("-j", "--bz2", "method", flag_value="bz2", help="Use BZ2.  [default for .bag]")
@click.option("--lz4", "method", flag_value="lz4", help="Use LZ4, which is faster.")
@click.option("--zstd", "method", flag_value="zstd", help="Use Zstandard.  [default for .mcap]")
@examples("{bag compress} lab.bag", "{bag compress} --lz4 --output-dir small *.bag")
def compress(method: str | None, **options: Any) -> None:
    """Compress bags.

    A new bag takes the place of each, whose original is kept as *.orig.bag. If that exists, it is
    kept as it is: the new bag has the same messages.
    """
    _rewrite_all(partial(_change_compression, method or "best"), keeps_all=True, **options)


@click.command()
@_options
@examples("{bag decompress} lab.bag")
def decompress(**options: Any) -> None:
    """Decompress bags.

    A new bag takes the place of each, whose original is kept as *.orig.bag. If that exists, it is
    kept as it is: the new bag has the same messages.
    """
    _rewrite_all(partial(_change_compression, "none"), keeps_all=True, **options)


@click.command("reindex")
@_options
@examples("{bag reindex} lab.bag.active", "{bag reindex} --output-dir restored *.bag")
def reindex_command(**options: Any) -> None:
    """Write an index for bags whose recorder ended before it closed them, and for damaged bags.

    A new bag takes the place of each, with all messages that can be read. Its original is kept as
    *.orig.bag.
    """
    _rewrite_all(_reindex, **options)


def _rewrite_all(
    rewrite: Rewrite,
    bags: tuple[Path, ...],
    output_dir: Path | None,
    force: bool,
    quiet: bool,
    *,
    keeps_all: bool = False,
) -> None:
    """Write all bags anew; go on after one that fails, and exit with 1 in the end.

    Args:
        keeps_all: whether the new bags have all messages of the old ones, so that the copy of an
            original that exists is kept instead of one more.
    """
    failed = False
    with clean_exit():
        if output_dir is not None:
            output_dir.mkdir(parents=True, exist_ok=True)
        for path in bags:
            try:
                _rewrite(rewrite, path, output_dir, force=force, quiet=quiet, keeps_all=keeps_all)
            except (BagError, OSError) as error:
                failed = True
                text = str(error)
                if isinstance(error, BagError) and str(path) not in text:
                    text = f"{path}: {text}"
                if isinstance(error, OSError):
                    text = f"{error.filename or path}: {error.strerror or error}"
                    if error.errno == errno.ENOSPC and output_dir is None:
                        text += "; --output-dir writes the new bag elsewhere"
                click.echo(output.visible(f"Error: {text}"), err=True)
    if failed:
        raise click.exceptions.Exit(1)


def _rewrite(
    rewrite: Rewrite,
    path: Path,
    output_dir: Path | None,
    *,
    force: bool,
    quiet: bool,
    keeps_all: bool,
) -> None:
    if path.is_dir():
        names = listed(os.fspath(path))
        if names and all(each.endswith(SQLITE_SUFFIX) for each in names):
            raise _only_read(path)
        files = " ".join(str(path / each) for each in names[:MOST_NAMES]) or path / "*.mcap"
        raise BagError(f"{path} is a folder; name the files in it: {files}")
    if path.suffix == SQLITE_SUFFIX:
        raise _only_read(path)
    target = path if output_dir is None else output_dir / path.name
    backup = None
    if output_dir is None or (target.exists() and target.samefile(path)):
        backup = path.with_name(f"{path.stem}.orig{path.suffix}")
        if backup.exists() and not force:
            if not keeps_all:
                raise BagError(
                    f"Skipping {path}. Backup path {backup} already exists; --force overwrites it."
                )
            backup = None  # The new file has the same messages.
    with (
        exit_on_signals(),
        replacing(target, backup=backup) as new,
        Progress(target, quiet=quiet) as progress,
    ):
        rewrite(path, new, progress)


def _only_read(path: Path) -> BagError:
    return BagError(
        f"{path}: SQLite (.db3) is only read; to convert it: {command_name('bag filter')} "
        f"{path} {path.with_suffix('.mcap')} True"
    )


def _change_compression(method: str, source: Path, target: Path, progress: Progress) -> None:
    with open_reader(source) as reader:
        if is_mcap(os.fspath(source)):
            progress.begin(sum(chunk.size for chunk in reader.chunks))
            method = "zstd" if method == "best" else method
            rewrite_mcap(os.fspath(source), os.fspath(target), method, is_strict=True)
            progress.finish()
            return
        method = "bz2" if method == "best" else method
        with open_writer(target, method, name=source) as writer:
            Copy(reader, writer).run(progress)


def _reindex(source: Path, target: Path, progress: Progress) -> None:
    progress.begin(source.stat().st_size)
    found = reindex(source, target)
    progress.finish()
    parts = [f"{output.counted(found.messages, 'message')} restored"]
    if found.lost:
        parts.append(f"{output.counted(found.lost, 'byte')} could not be read")
    if found.damaged:
        chunks = output.counted(found.damaged, "chunk")
        parts.append(f"messages of {chunks} may be wrong (checksum)")
    text = f"{output.visible(str(source))}: {'; '.join(parts)}"
    if len(parts) > 1:
        click.echo(text, err=True)
    elif not progress.is_quiet:
        output.line(text)
