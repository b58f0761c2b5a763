"""Metrics as text, in the formats of Prometheus and OpenMetrics.

Rendering is in the event loop's way, and prometheus_client takes ten times as long for it: about
10 µs for each line, of which a hub with 1,000 topics has thousands.

The formats: https://prometheus.io/docs/instrumenting/exposition_formats/ and
https://github.com/prometheus/OpenMetrics/blob/main/specification/OpenMetrics.md
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, NamedTuple, TypeAlias

from fibws.hub.graph.totals import Histogram

Kind: TypeAlias = Literal["counter", "gauge"]
Number: TypeAlias = int | float

PROMETHEUS = "text/plain; version=0.0.4; charset=utf-8"
OPENMETRICS = "application/openmetrics-text; version=1.0.0; charset=utf-8"
_ESCAPES = str.maketrans({"\\": r"\\", '"': r"\"", "\n": r"\n"})


class Rendered(NamedTuple):
    """A response's body and its type."""

    body: bytes
    content_type: str


class Column(NamedTuple):
    """One counter of several that have the same label.

    Attributes:
        name: without ``_total``.
        is_mostly_zero: whether values that are 0 are left out, which saves most of the lines.
    """

    name: str
    help: str
    is_mostly_zero: bool = False


class Exposition:
    """Collects metrics, line by line.

    Args:
        accept: the request's header ``Accept``: scrapers that prefer OpenMetrics name it there.
    """

    def __init__(self, accept: str = "") -> None:
        self._is_open = "application/openmetrics-text" in accept
        self._lines: list[str] = []

    def counter(self, name: str, help_: str, value: Number) -> None:
        """Add a counter; ``name`` comes without ``_total``."""
        self._describe(name, "counter", help_)
        self._lines.append(f"{name}_total {value}")

    def gauge(self, name: str, help_: str, value: Number) -> None:
        """Add a gauge."""
        self._describe(name, "gauge", help_)
        self._lines.append(f"{name} {value}")

    def info(self, name: str, help_: str, labels: Mapping[str, str]) -> None:
        """Add a gauge that is 1, and whose labels are what it says."""
        self._describe(name, "gauge", help_)
        pairs = ",".join(f'{label}="{escaped(value)}"' for label, value in labels.items())
        self._lines.append(f"{name}{{{pairs}}} 1")

    def counters(self, name: str, help_: str, label: str, values: Mapping[str, Number]) -> None:
        """Add a counter for each value of a label."""
        self._describe(name, "counter", help_)
        self._lines += (
            f'{name}_total{{{label}="{escaped(value)}"}} {count}' for value, count in values.items()
        )

    def gauges(self, name: str, help_: str, label: str, values: Mapping[str, Number]) -> None:
        """Add a gauge for each value of a label."""
        self._describe(name, "gauge", help_)
        self._lines += (
            f'{name}{{{label}="{escaped(value)}"}} {number}' for value, number in values.items()
        )

    def counter_table(
        self, columns: Sequence[Column], label: str, rows: Mapping[str, Iterable[Number]]
    ) -> None:
        """Add several counters that have the same label.

        Args:
            rows: the value of each column, by the label's value.
        """
        labels = [f'{{{label}="{escaped(value)}"}}' for value in rows]
        table = [*zip(*rows.values(), strict=True)] or [()] * len(columns)
        for column, counts in zip(columns, table, strict=True):
            self._describe(column.name, "counter", column.help)
            start, shows_zero = f"{column.name}_total", not column.is_mostly_zero
            self._lines += [
                f"{start}{each} {count}"
                for each, count in zip(labels, counts, strict=True)
                if count or shows_zero
            ]

    def counters_by_two(
        self,
        name: str,
        help_: str,
        labels: tuple[str, str],
        values: Iterable[tuple[tuple[str, str], Number]],
    ) -> None:
        """Add a counter for each pair of values of two labels."""
        self._describe(name, "counter", help_)
        first, second = labels
        self._lines += (
            f'{name}_total{{{first}="{escaped(one)}",{second}="{escaped(two)}"}} {count}'
            for (one, two), count in values
        )

    def histogram(self, name: str, help_: str, histogram: Histogram) -> None:
        """Add a histogram."""
        self._describe(name, "histogram", help_)
        bounds = [*map(str, histogram.bounds), "+Inf"]
        counts = histogram.cumulative()
        self._lines += (
            f'{name}_bucket{{le="{bound}"}} {count}'
            for bound, count in zip(bounds, counts, strict=True)
        )
        self._lines += (f"{name}_sum {histogram.sum}", f"{name}_count {counts[-1]}")

    def render(self) -> Rendered:
        """Return all of it."""
        lines = [*self._lines, *(["# EOF"] if self._is_open else []), ""]
        body = "\n".join(lines).encode("utf-8", "replace")
        return Rendered(body, OPENMETRICS if self._is_open else PROMETHEUS)

    def _describe(self, name: str, kind: str, help_: str) -> None:
        """Add the two lines before a metric's values.

        In Prometheus's format they name a counter as its values do, in OpenMetrics without _total.
        """
        family = f"{name}_total" if kind == "counter" and not self._is_open else name
        self._lines += (f"# HELP {family} {help_}", f"# TYPE {family} {kind}")


def escaped(value: str) -> str:
    """Return a label's value as it stands between quotation marks."""
    if '"' in value or "\\" in value or "\n" in value:
        return value.translate(_ESCAPES)
    return value
