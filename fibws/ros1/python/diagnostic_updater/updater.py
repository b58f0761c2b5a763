"""Tasks that check a device, and the updater that publishes what they find."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

OK: int = DiagnosticStatus.OK
WARN: int = DiagnosticStatus.WARN
ERROR: int = DiagnosticStatus.ERROR

NO_HARDWARE_ID = (
    "diagnostic_updater: No HW_ID was set. This is probably a bug: call setHardwareID, "
    "with 'none' for a device that has no HW_ID."
)
CHECK_INTERVAL = 0.25
"""Seconds between two reads of the parameter ``~diagnostic_period``."""


class DiagnosticStatusWrapper(DiagnosticStatus):  # type: ignore[misc]  # The class is made at run time.
    """A `diagnostic_msgs.msg.DiagnosticStatus` with methods to fill it."""

    level: int
    message: str

    def summary(self, *args: Any) -> None:
        """Set level and message, to those of another status or to the two arguments."""
        self.level, self.message = _level_and_message(args)

    def clearSummary(self) -> None:
        """Set level and message to OK and nothing."""
        self.summary(OK, "")

    def mergeSummary(self, *args: Any) -> None:
        """Add another level and message.

        The higher level remains. The messages are joined if both levels are OK, or neither is;
        otherwise the message of the one that is not remains.
        """
        level, message = _level_and_message(args)
        if (level > OK) == (self.level > OK):
            self.message = f"{self.message}; {message}" if self.message else message
        elif level > self.level:
            self.message = message
        self.level = max(level, self.level)

    def add(self, key: str, val: object) -> None:
        """Add a value, which is published as text."""
        self.values.append(KeyValue(key, str(val)))


def _level_and_message(args: Sequence[Any]) -> tuple[int, str]:
    if len(args) == 1:
        [status] = args
        return status.level, status.message
    level, message = args
    return level, str(message)


class DiagnosticTask:
    """A check with a name; subclasses override `run`."""

    def __init__(self, name: str) -> None:
        self.name = name

    def getName(self) -> str:
        """Return the name."""
        return self.name

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        return stat


class FunctionDiagnosticTask(DiagnosticTask):
    """A check that is a function.

    Args:
        fn: fills a status, and returns it.
    """

    def __init__(
        self, name: str, fn: Callable[[DiagnosticStatusWrapper], DiagnosticStatusWrapper]
    ) -> None:
        super().__init__(name)
        self.fn = fn

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Fill a status, and return it."""
        return self.fn(stat)


class CompositeDiagnosticTask(DiagnosticTask):
    """Several checks that fill one status; its summary is that of all."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.tasks: list[DiagnosticTask] = []

    def addTask(self, t: DiagnosticTask) -> None:
        """Add a check."""
        self.tasks.append(t)

    def run(self, stat: DiagnosticStatusWrapper) -> DiagnosticStatusWrapper:
        """Let each check fill a status that has the summary of the beginning; return it."""
        before, combined = DiagnosticStatusWrapper(), DiagnosticStatusWrapper()
        before.summary(stat)
        for task in self.tasks:
            stat.summary(before)
            stat = task.run(stat)
            combined.mergeSummary(stat)
        stat.summary(combined)
        return stat


class DiagnosticTaskVector:
    """Checks of which each fills a status of its own."""

    class DiagnosticTaskInternal:
        """A check as it is kept: its name and its function."""

        def __init__(self, name: str, fn: Callable[[Any], Any]) -> None:
            self.name = name
            self.fn = fn

        def run(self, stat: DiagnosticStatusWrapper) -> Any:
            """Fill a status, which gets the name of this."""
            stat.name = self.name
            return self.fn(stat)

    def __init__(self) -> None:
        self.tasks: list[DiagnosticTaskVector.DiagnosticTaskInternal] = []
        self.lock = threading.Lock()

    def addedTaskCallback(self, task: DiagnosticTaskInternal) -> None:
        """Do nothing; subclasses override it to learn of a new check."""

    def add(self, *args: Any) -> None:
        """Add a check: a `DiagnosticTask`, or a name and a function that fills a status.

        Raises:
            TypeError: the arguments are neither.
        """
        if len(args) == 1:
            [task] = args
            args = (task.getName(), task.run)
        if len(args) != 2:
            raise TypeError(f"expected a task, or a name and a function, got {len(args)} arguments")
        internal = self.DiagnosticTaskInternal(*args)
        with self.lock:
            self.tasks.append(internal)
            self.addedTaskCallback(internal)

    def removeByName(self, name: str) -> bool:
        """Remove the first check of this name; return whether there was one."""
        with self.lock:
            found = next((task for task in self.tasks if task.name == name), None)
            with suppress(ValueError):
                self.tasks.remove(found)  # type: ignore[arg-type]  # None is not among them.
        return found is not None


class Updater(DiagnosticTaskVector):
    """Runs checks, and publishes them on /diagnostics once in ``~diagnostic_period`` seconds.

    Call `update` often, at least as often as it is to publish.
    """

    def __init__(self) -> None:
        super().__init__()
        self.publisher = rospy.Publisher("/diagnostics", DiagnosticArray, queue_size=10)
        self.last_time = rospy.Time.now()
        self.last_time_period_checked = self.last_time
        self.period: float = 1
        self.verbose = False
        self.hwid = ""
        self.warn_nohwid_done = False

    def update(self) -> None:
        """Run all checks and publish, if it is time."""
        self._check_diagnostic_period()
        if rospy.Time.now() >= self.last_time + rospy.Duration(self.period):
            self.force_update()

    def force_update(self) -> None:
        """Run all checks and publish now."""
        self.last_time = rospy.Time.now()
        found = []
        with self.lock:
            for task in self.tasks:
                status = self._status(task, ERROR, "No message was set")
                status.hardware_id = self.hwid
                task.run(status)
                found.append(status)
        faulty = [status for status in found if status.level]
        if self.verbose:
            for status in faulty:
                rospy.logwarn(
                    "Non-zero diagnostic status. Name: '%s', status %i: '%s'",
                    *(status.name, status.level, status.message),
                )
        if not (self.hwid or faulty or self.warn_nohwid_done):
            rospy.logwarn(NO_HARDWARE_ID)
            self.warn_nohwid_done = True
        self.publish(found)

    def broadcast(self, lvl: int, msg: str) -> None:
        """Publish one level and message for all checks, which are not run."""
        self.publish([self._status(task, lvl, msg) for task in self.tasks])

    def setHardwareID(self, hwid: str) -> None:
        """Set what identifies the device, such as its serial number; ``none`` if nothing does."""
        self.hwid = hwid

    def publish(self, msg: DiagnosticStatus | list[DiagnosticStatus]) -> None:
        """Publish a status or several, with the node's name before theirs."""
        statuses = msg if isinstance(msg, list) else [msg]
        for status in statuses:
            status.name = f"{rospy.get_name()[1:]}: {status.name}"
        array = DiagnosticArray()
        array.status = statuses
        array.header.stamp = rospy.Time.now()
        self.publisher.publish(array)

    def addedTaskCallback(self, task: DiagnosticTaskVector.DiagnosticTaskInternal) -> None:
        """Publish that the check is there."""
        self.publish(self._status(task, OK, "Node starting up"))

    def _status(
        self, task: DiagnosticTaskVector.DiagnosticTaskInternal, level: int, message: str
    ) -> DiagnosticStatusWrapper:
        status = DiagnosticStatusWrapper()
        status.name = task.name
        status.summary(level, message)
        return status

    def _check_diagnostic_period(self) -> None:
        now = rospy.Time.now()
        if now >= self.last_time_period_checked + rospy.Duration(CHECK_INTERVAL):
            self.period = rospy.get_param_cached("~diagnostic_period", 1)
            self.last_time_period_checked = now
