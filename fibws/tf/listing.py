"""All frames of a buffer as text: YAML and DOT as tf2 writes them, and DOT as view_frames does."""

from __future__ import annotations

from collections.abc import Iterable

from fibws.tf.buffer import Buffer, FrameInfo

NO_AUTHORITY = "no recorded authority"


def as_yaml(buffer: Buffer) -> str:
    """Return a mapping from frames to parents, broadcasters and rates; ``{}`` if there are none.

    The text is the answer of ``~tf2_frames``.
    """
    if not buffer.frames():
        return "{}"
    return "".join(
        f"{info.frame}: \n"
        f"  parent: '{info.parent}'\n"
        f"  broadcaster: '{info.authority or NO_AUTHORITY}'\n"
        f"  rate: {_rate(info):.3f}\n"
        f"  most_recent_transform: {info.latest / 1e9:.3f}\n"
        f"  oldest_transform: {info.oldest / 1e9:.3f}\n"
        f"  buffer_length: {(info.latest - info.oldest) / 1e9:.3f}\n"
        for info in buffer.infos()
    )


def as_dot(buffer: Buffer, now: float = 0.0) -> str:
    """Return a graph for graphviz, as tf's allFramesAsDot.

    Args:
        now: the current time in seconds, for the ages of the transforms; 0 for none.
    """
    infos = buffer.infos()
    text = "digraph G {\n"
    if not buffer.frames():
        text += '"no tf data recieved"'
    for info in infos:
        age = f"( {now - info.latest / 1e9:.3f} sec old)" if now > 0 else ""
        text += (
            f'"{_escaped(info.parent)}" -> "{_escaped(info.frame)}"'
            f'[label="Broadcaster: {_escaped(info.authority or NO_AUTHORITY)}\\n'
            f"Average rate: {_rate(info):.3f} Hz\\n"
            f"Most recent transform: {info.latest / 1e9:.3f} {age}\\n"
            f'Buffer length: {(info.latest - info.oldest) / 1e9:.3f} sec\\n"];\n'
        )
    if now > 0:
        for root in _roots(buffer.frames(), infos):
            text += (
                "edge [style=invis];\n"
                " subgraph cluster_legend { style=bold; color=black; "
                'label ="view_frames Result";\n'
                f'"Recorded at time: {now:.3f}"[ shape=plaintext ] ;\n '
                f'}}->"{_escaped(root)}";\n'
            )
    return f"{text}}}"


def _roots(frames: Iterable[str], infos: list[FrameInfo]) -> list[str]:
    children = {info.frame for info in infos}
    return [frame for frame in frames if frame not in children]


def _rate(info: FrameInfo) -> float:
    return info.samples / max((info.latest - info.oldest) / 1e9, 0.0001)


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')
