"""Draws the tree of frames: a DOT file, and a PDF if graphviz is installed."""

from __future__ import annotations

import asyncio
import shutil
from contextlib import suppress
from pathlib import Path

import click

import fibws
from fibws.cli import node_program
from fibws.tf.buffer import Buffer
from fibws.tf.listener import TransformListener
from fibws.tf.listing import as_dot

SECONDS = 5.0
"""How long to listen, as in tf."""


async def listen(node: fibws.Node, duration: float) -> str:
    """Return the frames of some seconds as a graph for graphviz."""
    buffer = Buffer()
    with suppress(TimeoutError):
        async with asyncio.timeout(duration):
            await TransformListener(node, buffer, authorities=True).run()
    return as_dot(buffer, node.now().to_nanoseconds() / 1e9)


async def ask(node: fibws.Node, listener: str) -> str:
    """Return the frames that another node knows, as a graph for graphviz.

    Args:
        listener: a node with the service ``~tf_frames``, which tf's listeners in C++ have.

    Raises:
        fibws.FibwsError: there is no such service, or it fails.
    """
    response = await node.call(f"{node.resolve(listener)}/tf_frames", "tf/FrameGraph")
    return str(response.dot_graph)


async def draw(graph: str, folder: Path) -> list[Path]:
    """Write ``frames.gv``, and ``frames.pdf`` with graphviz; return what was written.

    Raises:
        OSError: a file cannot be written.
    """
    source, drawing = folder / "frames.gv", folder / "frames.pdf"
    source.write_text(graph, "utf-8")
    dot = shutil.which("dot")
    if dot is None:
        return [source]
    process = await asyncio.create_subprocess_exec(dot, "-Tpdf", str(source), "-o", str(drawing))
    return [source] if await process.wait() else [source, drawing]


@click.command(context_settings=node_program.SETTINGS)
@click.option(
    "--duration",
    type=click.FloatRange(0, min_open=True),
    metavar="SECONDS",
    default=SECONDS,
    show_default=True,
    help="Seconds to listen to /tf and /tf_static.",
)
@click.option(
    "-n",
    "--node",
    "listener",
    metavar="NAME",
    help="Draw the frames that this node knows, through its service ~tf_frames.",
)
@node_program.node("view_frames")
def command(node: fibws.Node, duration: float, listener: str | None) -> None:
    """Listen to /tf and /tf_static, and draw the tree of frames.

    frames.gv and frames.pdf are written to the current folder; the latter needs graphviz's dot.
    """

    async def program() -> None:
        async with node:
            if listener is not None:
                graph = await ask(node, listener)
            else:
                click.echo(f"Listening to /tf for {duration:f} seconds")
                graph = await listen(node, duration)
                click.echo("Done Listening")
        try:
            written = await draw(graph, Path())
        except OSError as error:
            raise click.ClickException(f"{error.filename}: {error.strerror}") from None
        for path in written:
            click.echo(f"{path} generated")
        if len(written) == 1:
            click.echo("frames.pdf needs graphviz: apt install graphviz", err=True)

    node_program.run(program())


if __name__ == "__main__":
    command(prog_name="python -m fibws.programs.view_frames")
