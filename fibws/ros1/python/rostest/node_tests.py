"""The programs of rostest that launch files use as tests of nodes: ``<test pkg="rostest" ...>``.

hztest, publishtest, advertisetest, subscribetest, servicetest and paramtest have the parameters of
http://wiki.ros.org/rostest/Nodes. The first argument is the program's name.
"""

from __future__ import annotations

import sys
import time
import unittest
from collections.abc import Callable, Collection
from itertools import pairwise
from threading import Condition
from typing import Any

import rosgraph
import rospy
import rosservice

import rostest

POLL_INTERVAL = 0.05
"""Seconds between two questions to the hub."""


_SERVICES = (rosservice.get_service_list, rosservice.get_service_type)


class HzTest(unittest.TestCase):
    """Measure the rate of a topic."""

    def test_hz(self) -> None:
        """Check ``~hz`` of ``~topic`` within ``~hzerror`` for ``~test_duration`` seconds."""
        hz = float(_required(self, "hz"))
        duration = float(_required(self, "test_duration"))
        error = float(_required(self, "hzerror")) if hz else 0.0
        self.assertGreaterEqual(hz, 0.0, "invalid parameter hz")
        self.assertGreaterEqual(error, 0.0, "invalid parameter hzerror")
        self.assertGreater(duration, 0.0, "invalid parameter test_duration")
        is_wall = bool(rospy.get_param("~wall_clock", False))
        now: Callable[[], float] = time.time if is_wall else rospy.get_time
        times: list[float] = []
        arrived = Condition()

        def on_message(message: object) -> None:
            with arrived:
                times.append(now())
                arrived.notify()

        subscriber = rospy.Subscriber(_required(self, "topic"), rospy.AnyMsg, on_message)
        with arrived:
            arrived.wait_for(lambda: times, timeout=float(rospy.get_param("~wait_time", 20.0)))
            if not hz:
                self.assertFalse(times, "a message was published")
            else:
                self.assertTrue(times, "no message before the timeout")
        if is_wall:
            time.sleep(duration)
        else:
            rospy.sleep(duration)
        subscriber.unregister()
        with arrived:
            self._check(list(times), hz, error)

    def _check(self, times: list[float], hz: float, error: float) -> None:
        if not hz:
            self.assertFalse(times, "a message was published")
            return
        self.assertGreater(len(times), 1, "only one message was published")
        self.assertGreater(times[-1], times[0], "time did not advance")
        rate = (len(times) - 1) / (times[-1] - times[0])
        self.assertGreaterEqual(rate, hz - error, f"average rate ({rate:.3f}Hz) is too low")
        self.assertLessEqual(rate, hz + error, f"average rate ({rate:.3f}Hz) is too high")
        if rospy.get_param("~check_intervals", False):
            for before, after in pairwise(times):
                self.assertGreaterEqual(after - before, 1 / (hz + error), "interval is too short")
                if hz > error:
                    self.assertLessEqual(after - before, 1 / (hz - error), "interval is too long")


class PublishTest(unittest.TestCase):
    """Wait for messages."""

    def test_publish(self) -> None:
        """Check that each of ``~topics`` has a message before its timeout, or none if negative."""
        topics = _listed(self, "topics")
        begin = rospy.get_time()
        heard: set[str] = set()
        for topic in topics:
            name = topic["name"]
            rospy.Subscriber(name, rospy.AnyMsg, lambda message, name=name: heard.add(name))
        waiting = topics
        while waiting and not rospy.is_shutdown():
            elapsed = rospy.get_time() - begin
            left = []
            for topic in waiting:
                if topic["name"] in heard:
                    self.assertFalse(topic["negative"], f"Topic [{topic['name']}] is published")
                elif elapsed <= topic["timeout"]:
                    left.append(topic)
                else:
                    self.assertTrue(topic["negative"], f"Topic [{topic['name']}] is not published")
            waiting = left
            rospy.sleep(POLL_INTERVAL)


class AdvertiseTest(unittest.TestCase):
    """Wait for topics and services."""

    def test_advertise_topics(self) -> None:
        """Check that ``~topics`` have publishers, or none if negative, and their types."""
        _check_names(
            self, _listed(self, "topics", "services"), "advertised", _published, _topic_type
        )

    def test_advertise_services(self) -> None:
        """Check that ``~services`` exist, or not if negative, and their types."""
        services = _listed(self, "services", "topics")
        _check_names(self, services, "advertised", *_SERVICES)


class SubscribeTest(unittest.TestCase):
    """Wait for subscribers."""

    def test_subscribe_topics(self) -> None:
        """Check that ``~topics`` have subscribers, or none if negative, and their types."""
        _check_names(self, _listed(self, "topics"), "subscribed", _subscribed, _topic_type)


class ServiceTest(unittest.TestCase):
    """Call services."""

    def test_advertise_service(self) -> None:
        """Check that the services of ``~calls`` exist within 10 s."""
        calls = [{"negative": False, "timeout": 10.0, **call} for call in self._calls()]
        _check_names(self, calls, "advertised", *_SERVICES)

    def test_service_call(self) -> None:
        """Check that each service of ``~calls`` responds to ``input`` by ``output``."""
        import yaml

        for call in self._calls():
            rospy.wait_for_service(call["name"], 10.0)
            proxy = rospy.ServiceProxy(
                call["name"], rosservice.get_service_class_by_name(call["name"])
            )
            given, expected = (
                {} if call[key] in (None, "None", "") else call[key] for key in ("input", "output")
            )
            self.assertEqual(yaml.safe_load(str(proxy(**given))) or {}, expected)

    def _calls(self) -> list[dict[str, Any]]:
        calls = _required(self, "calls")
        for call in calls:
            for key in ("name", "input", "output"):
                self.assertIn(key, call, f"a call has no {key}")
        return list(calls)


class ParamTest(unittest.TestCase):
    """Wait for a parameter."""

    def test_param(self) -> None:
        """Check that ``~param_name_target`` is set, to ``~param_value_target`` if that is given."""
        name = _required(self, "param_name_target")
        _wait(lambda: rospy.has_param(name), float(rospy.get_param("~wait_time", 20.0)))
        self.assertTrue(rospy.has_param(name), f"Parameter [{name}] is not set")
        if rospy.has_param("~param_value_target"):
            self.assertEqual(rospy.get_param(name), rospy.get_param("~param_value_target"))


PROGRAMS = {
    "hztest": HzTest,
    "publishtest": PublishTest,
    "advertisetest": AdvertiseTest,
    "subscribetest": SubscribeTest,
    "servicetest": ServiceTest,
    "paramtest": ParamTest,
}


def main() -> None:
    """Run the program that the first argument names."""
    name = sys.argv[1]
    rospy.init_node(name)
    rostest.rosrun("rostest", name, PROGRAMS[name])


def _required(test: unittest.TestCase, name: str) -> Any:
    """Return a private parameter; the test fails without it."""
    if not rospy.has_param(f"~{name}"):
        test.fail(f"Parameter [{rospy.resolve_name(f'~{name}')}] is not set")
    return rospy.get_param(f"~{name}")


def _listed(test: unittest.TestCase, name: str, *others: str) -> list[dict[str, Any]]:
    """Return the entries of a private parameter that is a list, with defaults.

    The test fails if this parameter and the ``others`` are all empty.
    """
    if not any(rospy.get_param(f"~{each}", []) for each in (name, *others)):
        test.fail(f"Parameter [{rospy.resolve_name(f'~{name}')}] is not set")
    entries = rospy.get_param(f"~{name}", [])
    for entry in entries:
        test.assertIn("name", entry, f"an entry of {name} has no name")
    defaults = {"timeout": 10.0, "type": None, "negative": False}
    return [{**defaults, **entry} for entry in entries]


def _check_names(
    test: unittest.TestCase,
    entries: list[dict[str, Any]],
    state: str,
    find: Callable[[], Collection[str]],
    type_of: Callable[[str], str | None],
) -> None:
    """Check that names appear before their timeouts, or do not if they are negative.

    Args:
        test: the test that fails otherwise.
        entries: the entries of a parameter.
        state: the word for names that exist, for errors: ``advertised``.
        find: returns all names that exist.
        type_of: returns the type of one of them.
    """
    begin = time.monotonic()
    waiting = entries
    while waiting:
        found = find()
        elapsed = time.monotonic() - begin
        left = []
        for entry in waiting:
            name = entry["name"]
            if (resolved := rospy.resolve_name(name)) in found:
                test.assertFalse(entry["negative"], f"[{name}] is {state}")
                if entry.get("type"):
                    test.assertEqual(type_of(resolved), entry["type"], f"type of [{name}]")
            elif elapsed <= entry["timeout"]:
                left.append(entry)
            else:
                test.assertTrue(entry["negative"], f"[{name}] is not {state}")
        waiting = left
        if waiting:
            time.sleep(POLL_INTERVAL)


def _wait(condition: Callable[[], object], timeout: float) -> None:
    end = time.monotonic() + timeout
    while not condition() and time.monotonic() < end:
        time.sleep(POLL_INTERVAL)


def _published() -> list[str]:
    return [name for name, _ in rospy.get_published_topics()]


def _subscribed() -> list[str]:
    return [name for name, _ in rosgraph.Master(rospy.get_name()).getSystemState()[1]]


def _topic_type(name: str) -> str | None:
    return dict(rosgraph.Master(rospy.get_name()).getTopicTypes()).get(name)


if __name__ == "__main__":
    main()
