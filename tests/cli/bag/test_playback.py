"""The course of a playback: dues, pauses, steps, rates, jumps, loops, latched messages."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from patience import PATIENCE

from fibws.bags import open_reader
from fibws.cli.bag.playback import Bags, Playback, PlaybackOptions
from fibws.msg.fibws_msgs import PlaybackState

from .conftest import SECOND, START, Entry, int32, write


class FakeTarget:
    """Notes what is published, and at which time of the playback."""

    def __init__(self, topic: str, course: Course) -> None:
        self.topic = topic
        self._course = course

    def publish(self, data: bytes) -> None:
        self._course.note(int.from_bytes(data, "little"))


class Course:
    """A playback that runs in a task."""

    def __init__(self) -> None:
        self.published: list[int] = []
        self.times: list[float] = []
        """When, in seconds of the event loop from the beginning."""
        self.positions: list[float] = []
        """The times of the playback, in seconds from `START`."""
        self.playback: Playback
        self.task: asyncio.Task[None]
        self.told: list[float] = []
        """What `on_time` was called with, in seconds from `START`."""
        self.skipped: list[int] = []
        self._loop = asyncio.get_running_loop()
        self._began = self._loop.time()
        self.news = asyncio.Event()

    def note(self, value: int) -> None:
        self.published.append(value)
        self.times.append(self._loop.time() - self._began)
        self.positions.append((self.playback.position - START) / SECOND)
        self.news.set()

    async def when(self, is_reached: Callable[[], bool]) -> None:
        """Wait until something is so after a message, or after a change of the playback."""
        async with asyncio.timeout(PATIENCE):
            while not is_reached():
                self.news.clear()
                await self.news.wait()

    async def until(self, *values: int) -> None:
        """Wait until these have been published, and nothing else."""
        await self.when(lambda: len(self.published) >= len(values))
        assert self.published == list(values)

    async def end(self) -> None:
        async with asyncio.timeout(PATIENCE):
            await self.task

    def tell(self, time: int) -> None:
        self.told.append((time - START) / SECOND)


@asynccontextmanager
async def playing(*paths: Path, **options: Any) -> AsyncIterator[Course]:
    """Play bags at once; options are those of `PlaybackOptions`, with times in seconds."""
    readers = [open_reader(path) for path in paths]
    course = Course()
    for name in ("start", "end"):
        if name in options:
            options[name] = START + round(options[name] * SECOND)
    found = {
        "start": min(each.start for each in readers),
        "end": max(each.end for each in readers),
        **options,
    }
    bags = Bags(
        [
            (reader, {each.id: FakeTarget(each.topic, course) for each in reader.connections})
            for reader in readers
        ],
        found["end"],
    )

    async def room() -> None:
        await asyncio.sleep(0)

    course.playback = Playback(
        bags,
        PlaybackOptions(**found),
        room,
        on_change=course.news.set,
        on_time=course.tell,
        on_skip=course.skipped.append,
    )
    course.task = asyncio.create_task(course.playback.run())
    try:
        yield course
    finally:
        course.task.cancel()
        await asyncio.wait([course.task])
        bags.close()
        for reader in readers:
            reader.close()


def numbers(*seconds: float) -> list[tuple[float, Entry]]:
    """Return messages at these times, which are numbered from 0."""
    return [(each, int32("/n", number)) for number, each in enumerate(seconds)]


async def test_messages_are_published_when_they_are_due(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 0.1, 0.3))
    async with playing(path) as course:
        await course.end()
    assert course.published == [0, 1, 2]
    for due, time in zip((0.0, 0.1, 0.3), course.times, strict=True):
        assert time >= due
    assert course.playback.status == PlaybackState.ENDED


async def test_rate_makes_it_faster(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 1000))
    async with playing(path, rate=1e5) as course:
        await course.end()
    assert course.published == [0, 1]


async def test_immediate_playback_waits_for_nothing(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(*range(0, 100_000, 100)))
    async with playing(path, is_immediate=True) as course:
        await course.end()
    assert course.published == list(range(1000))
    assert course.positions[:3] == [0, 100, 200]


async def test_bags_are_played_together_in_the_order_of_time(tmp_path: Path) -> None:
    first = write(tmp_path / "a.bag", (0, int32("/a", 0)), (2, int32("/a", 2)))
    second = write(tmp_path / "b.bag", (1, int32("/b", 1)), (3, int32("/b", 3)))
    async with playing(first, second, is_immediate=True) as course:
        await course.end()
    assert course.published == [0, 1, 2, 3]


async def test_start_and_end_bound_the_messages(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 1, 2, 3))
    async with playing(path, is_immediate=True, start=1, end=2) as course:
        await course.end()
    assert course.published == [1, 2]


async def test_last_latched_messages_before_the_start_are_published_first(tmp_path: Path) -> None:
    path = write(
        tmp_path / "a.bag",
        (0, int32("/map", 1, latching=True)),
        (1, int32("/map", 2, latching=True)),
        (1, int32("/map", 3, "/other", latching=True)),
        (1, int32("/n", 4)),
        (2, int32("/n", 5)),
    )
    async with playing(path, is_immediate=True, start=1.5) as course:
        await course.end()
    assert sorted(course.published[:2]) == [2, 3]
    assert course.published[2:] == [5]


async def test_pause_stops_the_time_and_steps_publish_one_message(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 100, 200, 300))
    async with playing(path, is_paused=True) as course:
        playback = course.playback
        assert playback.status == PlaybackState.PAUSED
        playback.step()
        await course.until(0)
        playback.step()
        playback.step()
        await course.until(0, 1, 2)
        assert course.positions == [0, 100, 200]
        assert course.told == [0, 0, 100, 200], "the beginning, and each message"
        assert playback.position == START + 200 * SECOND
        playback.set_rate(1e5)
        playback.pause(False)
        assert playback.status == PlaybackState.PLAYING
        await course.end()
    assert course.published == [0, 1, 2, 3]


async def test_pause_during_the_playback_takes_effect_at_once(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 1000, 2000))
    async with playing(path) as course:
        await course.until(0)
        course.playback.pause(True)
        position = course.playback.position
        await asyncio.sleep(0)
        assert course.playback.position == position < START + 1000 * SECOND
        course.playback.step()
        await course.until(0, 1)


@pytest.mark.parametrize("rate", [1e7, 1e308])
async def test_rate_can_be_changed_while_a_message_is_awaited(tmp_path: Path, rate: float) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 10_000))
    async with playing(path) as course:
        await course.until(0)
        course.playback.set_rate(rate)
        await asyncio.sleep(0)
        assert START < course.playback.position <= START + 10_000 * SECOND
        await course.end()
    assert course.published == [0, 1]


@pytest.mark.parametrize("rate", [0, -1, float("nan"), float("inf")])
async def test_invalid_rates_are_refused(tmp_path: Path, rate: float) -> None:
    path = write(tmp_path / "a.bag", *numbers(0))
    async with playing(path, is_paused=True) as course:
        with pytest.raises(ValueError, match="rate must be"):
            course.playback.set_rate(rate)


@pytest.mark.parametrize(("seconds", "first"), [(-5, 0), (0, 0), (150, 2), (200, 2), (1000, 3)])
async def test_seek_goes_on_at_another_time(tmp_path: Path, seconds: float, first: int) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 100, 200, 300))
    async with playing(path, is_paused=True) as course:
        course.playback.step()
        await course.until(0)
        course.playback.seek(START + round(seconds * SECOND))
        course.playback.step()
        await course.until(0, first)


async def test_seek_publishes_nothing_of_the_time_before(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 100))
    async with playing(path) as course:
        course.playback.seek(START + 100 * SECOND)
        await course.until(1)
        await course.end()
    assert course.published == [1]


async def test_seek_publishes_latched_messages(tmp_path: Path) -> None:
    path = write(
        tmp_path / "a.bag",
        (0, int32("/map", 100, latching=True)),
        (1, int32("/n", 1)),
        (1000, int32("/n", 2)),
    )
    async with playing(path, is_paused=True) as course:
        course.playback.seek(START + 500 * SECOND)
        await course.until(100)
        course.playback.step()
        await course.until(100, 2)


async def test_playback_that_stays_plays_again_after_a_seek(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 0.001))
    async with playing(path, stays=True) as course:
        await course.until(0, 1)
        await course.when(lambda: course.playback.status == PlaybackState.ENDED)
        assert not course.task.done()
        course.playback.seek(START)
        await course.until(0, 1, 0, 1)


async def test_loop_begins_again(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 0.001))
    async with playing(path, is_loop=True) as course:
        await course.when(lambda: len(course.published) >= 6)
    assert course.published[:6] == [0, 1] * 3


async def test_empty_spans_are_skipped(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 0.01, 1000, 1000.01))
    async with playing(path, skip_empty=SECOND) as course:
        await course.end()
    assert course.published == [0, 1, 2, 3]
    [skipped] = course.skipped
    assert 999 * SECOND < skipped < 1000 * SECOND


async def test_pause_topics_pause_before_each_of_their_messages(tmp_path: Path) -> None:
    path = write(
        tmp_path / "a.bag",
        (0, int32("n", 0)),
        (0.001, int32("goal", 1)),
        (0.002, int32("n", 2)),
        (0.003, int32("goal", 3)),
        (0.004, int32("n", 4)),
    )
    async with playing(path, pause_topics={"goal"}) as course:
        playback = course.playback
        await course.until(0)
        await course.when(lambda: playback.is_paused)
        playback.pause(False)
        await course.until(0, 1, 2)
        await course.when(lambda: playback.is_paused)
        playback.toggle_pause_topics()
        playback.pause(False)
        await course.end()
    assert course.published == [0, 1, 2, 3, 4]


async def test_playback_waits_for_the_control(tmp_path: Path) -> None:
    path = write(tmp_path / "a.bag", *numbers(0, 0.5, 5))
    async with playing(path, rate=1e4, max_delay=SECOND) as course:
        course.playback.controlled = START
        await course.until(0, 1)
        await course.when(lambda: course.playback.status == PlaybackState.DELAYED)
        assert course.published == [0, 1]
        course.playback.controlled = START + 5 * SECOND
        await course.end()
    assert course.published == [0, 1, 2]
