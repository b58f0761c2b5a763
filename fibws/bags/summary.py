"""What is in a bag, in the words of ``rosbag info``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from itertools import pairwise
from statistics import median
from typing import Any

from fibws.bags.connection import Connection
from fibws.bags.reader import MAX_GAP, Reader
from fibws.bags.ros2_messages import CDR, ROS1, with_encoding

DAY = 86400
"""In seconds."""


@dataclass(frozen=True, slots=True)
class TopicSummary:
    """What a bag has of a topic."""

    topic: str
    type: str
    messages: int
    connections: int
    frequency: float | None
    """The inverse of the median of the periods between messages, in Hz; None if there is none."""


@dataclass(frozen=True, slots=True)
class Compression:
    """The chunks of a bag with one compression method."""

    method: str
    chunks: int
    compressed: int
    """Their size in bytes."""
    uncompressed: int


def topics(
    reader: Reader, connections: Iterable[Connection], *, frequencies: bool = False
) -> list[TopicSummary]:
    """Return what a bag has of each topic, sorted by name.

    Args:
        connections: those to count.
        frequencies: whether to measure frequencies, which takes the times of all messages.
    """
    counts = reader.counts
    by_topic: dict[str, list[Connection]] = {}
    for each in connections:
        by_topic.setdefault(each.topic, []).append(each)
    return [
        TopicSummary(
            topic=topic,
            type=by_topic[topic][0].type,
            messages=sum(counts.get(each.id, 0) for each in by_topic[topic]),
            connections=len(by_topic[topic]),
            frequency=_frequency(reader, by_topic[topic]) if frequencies else None,
        )
        for topic in sorted(by_topic)
    ]


def _frequency(reader: Reader, connections: list[Connection]) -> float | None:
    # As floating-point numbers of seconds, like rosbag's; a difference shows in the last digits.
    stamps = [time / 1e9 for time in reader.times(connections)]
    if len(stamps) < 2:
        return None
    period = median(after - before for before, after in pairwise(stamps))
    return 1 / period if period > 0 else None


def types(connections: Iterable[Connection]) -> dict[str, str]:
    """Return the md5sums of types, sorted by name; if a type has several, the first one."""
    found: dict[str, str] = {}
    for each in connections:
        found.setdefault(each.type, each.md5sum)
    return dict(sorted(found.items()))


def compressions(reader: Reader) -> list[Compression]:
    """Return how chunks are compressed, the most frequent method first."""
    found: dict[str, list[int]] = {}
    for chunk in reader.chunks:
        sums = found.setdefault(chunk.compression, [0, 0, 0])
        sums[0] += 1
        sums[1] += chunk.compressed_size
        sums[2] += chunk.size
    return sorted(
        (Compression(method, *sums) for method, sums in found.items()),
        key=lambda each: (each.chunks, each.method),
        reverse=True,
    )


def text(reader: Reader, path: str | None, *, frequencies: bool = False) -> str:
    """Return a summary as a person reads it, like ``rosbag info``.

    Args:
        path: the bag's path, as the person wrote it.
        frequencies: whether to measure the frequencies of topics.
    """
    rows = [("path", path)] if path else []
    rows.append(("version", reader.version))
    if reader.chunks:
        start, end = reader.start / 1e9, reader.end / 1e9
        rows += [
            ("duration", _duration(end - start)),
            ("start", f"{_date(start)} ({start:.2f})"),
            ("end", f"{_date(end)} ({end:.2f})"),
            ("size", size_text(reader.size)),
            ("messages", str(reader.message_count)),
            *_compression_rows(reader, end - start),
            *_encoding_rows(reader),
            *_type_rows(reader),
            *_topic_rows(reader, frequencies=frequencies),
        ]
    else:
        rows.append(("size", size_text(reader.size)))
    width = max(len(name) for name, _ in rows) + 1
    return "\n".join(f"{f'{name}:' if name else '':{width}} {it}" for name, it in rows).rstrip()


def _encoding_rows(reader: Reader) -> Iterator[tuple[str, str]]:
    """Say which messages are not ROS 1's, and which of them cannot be read as those."""
    found = encodings(reader)
    if found == [ROS1]:
        return
    yield "encoding", ", ".join(f"{each} (ROS 2)" if each == CDR else each for each in found)
    for number, fault in enumerate(conversion_faults(reader)):
        yield "" if number else "differences", fault


def encodings(reader: Reader) -> list[str]:
    """Return how messages are encoded: ``ros1``, ``cdr`` or others."""
    return sorted({each.encoding for each in reader.connections} or {ROS1})


def conversion_faults(reader: Reader) -> list[str]:
    """Say which messages cannot be converted to ROS 1's, and which of their types differ."""
    found = with_encoding(reader, ROS1)
    differences = [f"{each}: nodes with ROS 1's cannot receive it" for each in found.differences]
    return [*found.not_converted.values(), *differences]


def _compression_rows(reader: Reader, duration: float) -> Iterator[tuple[str, str]]:
    found = compressions(reader)
    total = len(reader.chunks)
    yield (
        "compression",
        ", ".join(
            f"{each.method} [{each.chunks}/{total} chunks]"
            if each.method == "none"
            else f"{each.method} [{each.chunks}/{total} chunks; {_percent(each)}]"
            for each in found
        ),
    )
    if all(each.method == "none" for each in found):
        return
    everything = Compression(
        "", total, sum(each.compressed for each in found), sum(each.uncompressed for each in found)
    )
    sizes = [everything.uncompressed, everything.compressed]
    plain, packed = _aligned(sizes)
    if duration > 0:
        rates = _aligned([size / duration for size in sizes])
        plain = f"{plain} @ {rates[0]}/s"
        packed = f"{packed} @ {rates[1]}/s ({_percent(everything)})"
    yield "uncompressed", plain
    yield "compressed", packed


def _percent(chunks: Compression) -> str:
    return f"{100 * chunks.compressed / max(1, chunks.uncompressed):.2f}%"


def _aligned(sizes: list[float] | list[int]) -> list[str]:
    texts = [size_text(size) for size in sizes]
    width = max(map(len, texts))
    return [each.rjust(width) for each in texts]


def _type_rows(reader: Reader) -> Iterator[tuple[str, str]]:
    found = types(reader.connections)
    width = max(map(len, found), default=0)
    for number, (name, md5sum) in enumerate(found.items()):
        row = f"{name:{width}} [{md5sum}]" if md5sum else name  # Types of ROS 2 have none.
        yield "" if number else "types", row


def _topic_rows(reader: Reader, *, frequencies: bool) -> Iterator[tuple[str, str]]:
    found = topics(reader, reader.connections, frequencies=frequencies)
    if not found:
        return
    name_width = max(len(each.topic) for each in found)
    type_width = max(len(each.type) for each in found)
    count_width = max(len(str(each.messages)) for each in found)
    rates = ["" if each.frequency is None else _frequency_text(each.frequency) for each in found]
    rate_width = max(map(len, rates))
    for number, (each, rate) in enumerate(zip(found, rates, strict=True)):
        unit = "msgs" if each.messages > 1 else "msg "
        row = f"{each.topic:{name_width}}   {each.messages:{count_width}} {unit}"
        row += f" @ {rate:>{rate_width}}" if rate else f"   {'':{rate_width}}"
        row += f" : {each.type:{type_width}}"
        if each.connections > 1:
            row += f" ({each.connections} connections)"
        yield "" if number else "topics", row


def as_dict(reader: Reader, path: str | None, *, frequencies: bool = False) -> dict[str, Any]:
    """Return a summary for programs, with the keys of ``rosbag info --yaml``.

    Args:
        path: the bag's path, as the person wrote it.
        frequencies: whether to measure the frequencies of topics.
    """
    found: dict[str, Any] = {"path": path} if path else {}
    version = reader.version
    found["version"] = float(version) if version.replace(".", "", 1).isdigit() else version
    if not reader.chunks:
        return {**found, "size": reader.size, "indexed": False}
    start, end = reader.start / 1e9, reader.end / 1e9
    methods = compressions(reader)
    found |= {
        "duration": round(end - start, 6),
        "start": round(start, 6),
        "end": round(end, 6),
        "size": reader.size,
        "messages": reader.message_count,
        "indexed": True,
        "compression": methods[0].method,
    }
    if any(each.method != "none" for each in methods):
        found["uncompressed"] = sum(each.uncompressed for each in methods)
        found["compressed"] = sum(each.compressed for each in methods)
    if (codes := encodings(reader)) != [ROS1]:
        found["encodings"] = codes
        if faults := conversion_faults(reader):
            found["differences"] = faults
    md5sums = types(reader.connections).items()
    found["types"] = [{"type": name, "md5": md5sum} for name, md5sum in md5sums]
    found["topics"] = []
    for each in topics(reader, reader.connections, frequencies=frequencies):
        row = {"topic": each.topic, "type": each.type, "messages": each.messages}
        if each.connections > 1:
            row["connections"] = each.connections
        if each.frequency is not None:
            row["frequency"] = round(each.frequency, 4)
        found["topics"].append(row)
    return found


class UnknownKey(KeyError):
    """A summary has no value of a key.

    Attributes:
        name: the part of the key that is not there.
        known: the names that are.
    """

    def __init__(self, name: str, known: list[str]) -> None:
        self.name = name
        self.known = known
        super().__init__(name)


def value_text(summary: dict[str, Any], key: str) -> str:
    """Return the value of a key of `as_dict`, such as ``topics[0].type``, as rosbag prints it.

    Raises:
        UnknownKey: the summary has no such key.
    """
    value: Any = summary
    for name in key.replace("[", ".[").split("."):
        try:
            value = value[int(name.strip("[]")) if name.startswith("[") else name]
        except (KeyError, IndexError, TypeError, ValueError):
            raise UnknownKey(name, list(value) if isinstance(value, dict) else []) from None
    return _plain(value)


def _plain(value: Any, indent: str = "") -> str:
    if isinstance(value, list):
        return "".join(f"{indent}- {_plain(each, f'{indent}  ')}\n" for each in value)
    if isinstance(value, dict):
        return f"\n{indent}".join(f"{name}: {each}" for name, each in value.items())
    return f"{indent}{value}"


_DECIMALS = {"duration": 6, "start": 6, "end": 6, "frequency": 4, "version": 1}


def as_yaml(summary: dict[str, Any]) -> str:
    """Return `as_dict` as ``rosbag info --yaml`` writes it."""
    import json  # Few need it.

    lines = []
    for key, value in summary.items():
        if isinstance(value, list):
            lines.append(f"{key}:")
            for row in value:
                if isinstance(row, str):
                    lines.append(f"    - {json.dumps(row, ensure_ascii=False)}")
                    continue
                items = [f"{name}: {_yaml_value(name, it)}" for name, it in row.items()]
                lines += [
                    f"    {'- ' if not number else '  '}{it}" for number, it in enumerate(items)
                ]
        else:
            lines.append(f"{key}: {_yaml_value(key, value)}")
    return "\n".join(lines) + "\n"


def _yaml_value(key: str, value: Any) -> str:
    return f"{value:.{_DECIMALS[key]}f}" if isinstance(value, float) else str(value) or "''"


def _duration(seconds: float) -> str:
    if seconds >= MAX_GAP / 1e9:
        return f"{span_text(seconds)}: messages have times of different clocks"
    if seconds >= 2 * DAY:
        return f"{span_text(seconds)} ({int(seconds)}s)"
    minutes = int(seconds / 60)
    if minutes >= 60:
        return f"{minutes // 60}hr {minutes % 60}:{int(seconds % 60):02}s ({int(seconds)}s)"
    if minutes > 0:
        return f"{minutes}:{int(seconds % 60):02}s ({int(seconds)}s)"
    return f"{seconds:.1f}s"


def span_text(seconds: float) -> str:
    """Return a long time as people say it, such as ``3.5 hours`` or ``53.9 years``."""
    for size, unit in ((365.25 * DAY, "years"), (DAY, "days")):
        if seconds >= 2 * size:
            return f"{seconds / size:.1f} {unit}"
    return f"{seconds / 3600:.1f} hours"


def _date(seconds: float) -> str:
    whole, hundredths = divmod(round(seconds * 100), 100)
    return f"{datetime.fromtimestamp(whole):%b %d %Y %H:%M:%S}.{hundredths:02}"


def size_text(size: float) -> str:
    """Return a size in bytes as ``rosbag info`` writes it: in KB and so on, of 1024 bytes each."""
    return _with_unit(size / 1024, 1024, ("KB", "MB", "GB", "TB"))


def _frequency_text(frequency: float) -> str:
    return _with_unit(frequency, 1000, ("Hz", "kHz", "MHz", "GHz"))


def _with_unit(value: float, factor: int, units: Sequence[str]) -> str:
    number = 0
    while value >= factor and number + 1 < len(units):
        value /= factor
        number += 1
    return f"{value:.1f} {units[number]}"
