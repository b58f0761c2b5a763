"""What `fibws top` says of a number, and its tables as plain text."""

from __future__ import annotations

from fibws.cli import output
from fibws.cli.top.measure import Client, Measure, Topic

TOPIC_HEADS = ("TOPIC", "RATE", "BANDWIDTH", "PUBS", "SUBS", "DROPS")
CLIENT_HEADS = ("NODE", "ADDRESS", "KEPT", "DROPS", "STATE")


def topic_cells(topic: Topic, *, is_measured: bool = True) -> tuple[str, ...]:
    """The cells of a topic's row, under `TOPIC_HEADS`; at the first look there is no rate yet."""
    grown = f" (+{topic.dropped})" if topic.dropped else ""
    return (
        topic.topic,
        f"{topic.rate:.2f}Hz" if is_measured else "-",
        f"{amount(topic.bandwidth)}/s" if is_measured else "-",
        str(topic.publishers),
        str(topic.subscribers),
        f"{topic.dropped_in_all}{grown}",
    )


def client_cells(client: Client) -> tuple[str, ...]:
    """The cells of a client's row, under `CLIENT_HEADS`."""
    state = "slow" if client.slow else "ok"
    return client.node, client.address, amount(client.kept_bytes), str(client.dropped), state


def amount(number: float) -> str:
    """Bytes as rostopic bw writes them: ``12.34KB`` are 12 340."""
    for unit, size in (("GB", 1e9), ("MB", 1e6), ("KB", 1e3)):
        if number >= size:
            return f"{number / size:.2f}{unit}"
    return f"{number:.2f}B" if number % 1 else f"{number:.0f}B"


def block(measure: Measure) -> None:
    """Print a measure as two tables with an empty line behind each."""
    output.table(TOPIC_HEADS, map(topic_cells, measure.topics))
    output.line()
    output.table(CLIENT_HEADS, map(client_cells, measure.clients))
    output.line()
