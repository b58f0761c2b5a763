"""Ready-made checks: of rates, of time stamps, and of topics."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Mapping
from typing import Any

import rospy

from diagnostic_updater.updater import (
    ERROR,
    OK,
    WARN,
    CompositeDiagnosticTask,
    DiagnosticStatusWrapper,
    DiagnosticTask,
    Updater,
)


class FrequencyStatusParam:
    """The limits of `FrequencyStatus`.

    Args:
        freq_bound: ``min`` and ``max``, in Hz; without ``max`` no rate is too high.
        tolerance: the part of a bound by which it may be missed.
        window_size: the number of the last updates over which events are counted.
    """

    def __init__(
        self, freq_bound: Mapping[str, float], tolerance: float = 0.1, window_size: int = 5
    ) -> None:
        self.freq_bound = freq_bound
        self.tolerance = tolerance
        self.window_size = window_size


class FrequencyStatus(DiagnosticTask):
    """Checks the rate of events."""

    def __init__(self, params: FrequencyStatusParam, name: str = "FrequencyStatus") -> None:
        super().__init__(name)
        self.params = params
        self.lock = threading.Lock()
        self.clear()

    def clear(self) -> None:
        """Forget all events."""
        with self.lock:
            self.count = 0
            size = self.params.window_size
            self._window = deque([(rospy.Time.now(), 0)] * size, maxlen=size)
            """The times of the last updates, each with the events that there were by then."""

    def tick(self) -> None:
        """Count an event."""
        with self.lock:
            self.count += 1

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        bounds, tolerance = self.params.freq_bound, self.params.tolerance
        least, most = bounds["min"] * (1 - tolerance), None
        if "max" in bounds:
            most = bounds["max"] * (1 + tolerance)
        with self.lock:
            now = rospy.Time.now()
            start, before = self._window[0]
            self._window.append((now, self.count))
            events, total = self.count - before, self.count
        duration = (now - start).to_sec()
        frequency = events / duration if duration else 0.0
        if events == 0:
            stat.summary(ERROR, "No events recorded.")
        elif frequency < least:
            stat.summary(WARN, "Frequency too low.")
        elif most is not None and frequency > most:
            stat.summary(WARN, "Frequency too high.")
        else:
            stat.summary(OK, "Desired frequency met")
        stat.add("Events in window", f"{events}")
        stat.add("Events since startup", f"{total}")
        stat.add("Duration of window (s)", f"{duration:f}")
        stat.add("Actual frequency (Hz)", f"{frequency:f}")
        if bounds.get("max") == bounds["min"]:
            stat.add("Target frequency (Hz)", f"{bounds['min']:f}")
        if bounds["min"] > 0:
            stat.add("Minimum acceptable frequency (Hz)", f"{least:f}")
        if most is not None:
            stat.add("Maximum acceptable frequency (Hz)", f"{most:f}")
        return stat


class TimeStampStatusParam:
    """The limits of `TimeStampStatus`.

    Args:
        min_acceptable: the least age of a stamp, in seconds; negative for one in the future.
        max_acceptable: the greatest age.
    """

    def __init__(self, min_acceptable: float = -1, max_acceptable: float = 5) -> None:
        self.min_acceptable = min_acceptable
        self.max_acceptable = max_acceptable


class TimeStampStatus(DiagnosticTask):
    """Checks the ages of time stamps."""

    def __init__(
        self, params: TimeStampStatusParam | None = None, name: str = "Timestamp Status"
    ) -> None:
        super().__init__(name)
        self.params = params or TimeStampStatusParam()
        self.lock = threading.Lock()
        self.early_count = self.late_count = self.zero_count = 0
        self._clear()

    def _clear(self) -> None:
        self.zero_seen = self.deltas_valid = False
        self.min_delta: float = 0
        self.max_delta: float = 0

    def tick(self, stamp: Any) -> None:
        """Count a stamp, a `rospy.Time` or seconds as a float."""
        seconds = stamp if isinstance(stamp, float) else stamp.to_sec()
        with self.lock:
            if seconds == 0:
                self.zero_seen = True
                return
            age = rospy.Time.now().to_sec() - seconds
            self.max_delta = max(age, self.max_delta) if self.deltas_valid else age
            self.min_delta = min(age, self.min_delta) if self.deltas_valid else age
            self.deltas_valid = True

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        params = self.params
        with self.lock:
            stat.summary(OK, "Timestamps are reasonable.")
            if not self.deltas_valid:
                stat.summary(WARN, "No data since last update.")
            else:
                if self.min_delta < params.min_acceptable:
                    stat.summary(ERROR, "Timestamps too far in future seen.")
                    self.early_count += 1
                if self.max_delta > params.max_acceptable:
                    stat.summary(ERROR, "Timestamps too far in past seen.")
                    self.late_count += 1
                if self.zero_seen:
                    stat.summary(ERROR, "Zero timestamp seen.")
                    self.zero_count += 1
            stat.add("Earliest timestamp delay:", f"{self.min_delta:f}")
            stat.add("Latest timestamp delay:", f"{self.max_delta:f}")
            stat.add("Earliest acceptable timestamp delay:", f"{params.min_acceptable:f}")
            stat.add("Latest acceptable timestamp delay:", f"{params.max_acceptable:f}")
            stat.add("Late diagnostic update count:", self.late_count)
            stat.add("Early diagnostic update count:", self.early_count)
            stat.add("Zero seen diagnostic update count:", self.zero_count)
            self._clear()
        return stat


class Heartbeat(DiagnosticTask):
    """Shows that the node is alive."""

    def __init__(self) -> None:
        super().__init__("Heartbeat")

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        stat.summary(OK, "Alive")
        return stat


class HeaderlessTopicDiagnostic(CompositeDiagnosticTask):
    """Checks the rate of a topic.

    Args:
        name: the topic's.
        diag: the updater, to which this is added.
        freq: the expected rate.
    """

    def __init__(self, name: str, diag: Updater, freq: FrequencyStatusParam) -> None:
        super().__init__(f"{name} topic status")
        self.diag = diag
        self.freq = FrequencyStatus(freq)
        self.addTask(self.freq)
        self.diag.add(self)

    def tick(self, *args: Any) -> None:
        """Count a message."""
        self.freq.tick()

    def clear_window(self) -> None:
        """Forget all messages."""
        self.freq.clear()


class TopicDiagnostic(HeaderlessTopicDiagnostic):
    """Checks the rate of a topic, and its time stamps."""

    def __init__(
        self, name: str, diag: Updater, freq: FrequencyStatusParam, stamp: TimeStampStatusParam
    ) -> None:
        super().__init__(name, diag, freq)
        self.stamp = TimeStampStatus(stamp)
        self.addTask(self.stamp)

    def tick(self, stamp: Any) -> None:
        """Count a message with this stamp."""
        self.stamp.tick(stamp)
        super().tick()


class DiagnosedPublisher(TopicDiagnostic):
    """A publisher whose rate and time stamps are checked.

    Args:
        pub: a `rospy.Publisher` of messages with a header.
    """

    def __init__(
        self,
        pub: rospy.Publisher,
        diag: Updater,
        freq: FrequencyStatusParam,
        stamp: TimeStampStatusParam,
    ) -> None:
        super().__init__(pub.name, diag, freq, stamp)
        self.publisher = pub

    def publish(self, message: Any) -> None:
        """Publish a message, and count it."""
        self.tick(message.header.stamp)
        self.publisher.publish(message)
