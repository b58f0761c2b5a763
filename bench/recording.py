"""Recording and playing bags: costs in the hub and in nodes, the recorder's rate, the timing."""

from __future__ import annotations

import logging
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from bench.environments import STOP_SECONDS, Environment, on_hub
from bench.machine import cpu_seconds
from bench.measure import HUB, BenchError, Plan, Repeated
from bench.report import Report
from fibws.bag_recorder import Origin, Recorder, RecordingOptions
from fibws.bags import open_reader, open_writer

TOPIC = "/bench_numbers"
HZ = 10_000
"""A rate that subscribers keep up with."""
LIMIT_AGAINST_SUBSCRIBER = 1.3
SMALL, LARGE = 4, 1_000_000
LIMITS_US = {SMALL: 10.0, LARGE: 10_000.0}
"""100,000 numbers, or 100 MB, in a second of one CPU."""
PLAY_HZ = 1000
LIMIT_JITTER_MS, LIMIT_DRIFT_PERCENT = 5.0, 0.1
FAST = 10
BAG_BYTES, QUICK_BAG_BYTES = 2_000_000_000, 100_000_000
LIMIT_MEMORY_MB = 100.0
_START = 1_700_000_000 * 10**9
_INT32 = ("std_msgs/Int32", "da5909fbe378aeaf85e547e830cc1bb7", "int32 data\n")
_BYTES = ("std_msgs/UInt8MultiArray", "82373f1612381bb6ee473b5cd6f5d89c", "")
"""A type whose messages are large; the hub knows its definition."""


def recording(plan: Plan, report: Report) -> None:
    """Measure the recorder alone, then with the hub, then playbacks."""
    with tempfile.TemporaryDirectory() as folder:
        _measure_recorder(Path(folder), plan, report)
        _measure_recording(Path(folder), plan, report)
        _measure_playing(Path(folder), plan, report)


# The recorder alone.


def _measure_recorder(folder: Path, plan: Plan, report: Report) -> None:
    rows = []
    for size, per_second in ((SMALL, 200_000), (LARGE, 200)):
        count = round(per_second * plan.seconds)
        runs = [_record_alone(folder, size, count) for _ in range(plan.reps)]
        rates = Repeated.of(count / seconds for seconds, _ in runs)
        cpu = Repeated.of(each / count * 1e6 for _, each in runs)
        report.record("recorder", bytes=size, rate=rates.median, cpu_us=cpu.median)
        value, unit = rates.median, "messages"
        if size == LARGE:
            value, unit = value * size / 1e6, "MB"
        limit = LIMITS_US[size]
        verdict = report.check(HUB, f"recording messages of {size:,} B", cpu.median, limit, " µs")
        rows.append((f"{size:,} B", f"{value:,.0f} {unit}/s", f"{cpu}", verdict))
    report.table(
        f"The recorder alone, to a disk: rate and CPU µs per message, minimum (median) of "
        f"{plan.reps}",
        ("messages of", "rate", "CPU", "limit"),
        rows,
    )


def _record_alone(folder: Path, size: int, count: int) -> tuple[float, float]:
    """Return the seconds, and the CPU seconds, in which messages are recorded."""
    options = RecordingOptions(path=str(folder / "alone.bag"), dated=False, min_space=0)
    recorder = Recorder(options, time.time_ns, logging.getLogger("bench"))
    stream = recorder.stream(Origin(TOPIC, *_INT32, "/bench", False))
    data = bytes(size)
    started, cpu = time.perf_counter(), time.process_time()
    recorder.start()
    for number in range(count):
        recorder.put(stream, _START + number, data)
        if not number % 100:
            while recorder.state().buffered > 64e6:
                time.sleep(0.001)
    recorder.stop()
    state = recorder.state()
    if state.messages != count:
        raise BenchError(f"the recorder has written {state.messages} of {count} messages")
    return time.perf_counter() - started, time.process_time() - cpu


# Recording with the hub.


class Recorded(NamedTuple):
    """The costs of one run."""

    hub_us: float
    """CPU time of the hub per message."""
    other_us: float
    """CPU time of the recorder, or of the subscriber, per message."""
    lost: int


def _measure_recording(folder: Path, plan: Plan, report: Report) -> None:
    costs: dict[str, list[Recorded]] = {"subscriber": [], "hub": [], "node": []}
    for rep in range(plan.reps):
        for how, found in costs.items():
            run = _record(folder, how, plan)
            found.append(run)
            report.record("recording", how=how, rep=rep, **run._asdict())
            if run.lost:
                report.fault(HUB, f"recording by {how}", f"lost {run.lost} messages")
    hub = {how: Repeated.of(run.hub_us for run in found) for how, found in costs.items()}
    ratio = Repeated.ratio(
        [run.hub_us for run in costs["hub"]], [run.hub_us for run in costs["subscriber"]]
    )
    what = "recording in the hub, against one subscriber"
    verdict = report.check(HUB, what, ratio.median, LIMIT_AGAINST_SUBSCRIBER)
    others = {how: Repeated.of(run.other_us for run in found) for how, found in costs.items()}
    report.table(
        f"std_msgs/Int32 at {HZ:,} Hz: CPU µs per message, minimum (median) of {plan.reps}",
        ("messages go to", "hub", "against one subscriber", "receiver", "limit"),
        [
            ("one fibws.Node", f"{hub['subscriber']}", "", f"{others['subscriber']}", ""),
            ("a recording in the hub", f"{hub['hub']}", f"{ratio}", "", verdict),
            ("fibws bag record", f"{hub['node']}", "", f"{others['node']}", ""),
        ],
    )


def _record(folder: Path, how: str, plan: Plan) -> Recorded:
    """Publish numbers; they are recorded in the hub, by a node, or only received."""
    count = round(HZ * plan.seconds)
    path = folder / "recorded.bag"
    options = ("--record", str(folder / "hub"), "--record-size", "0") if how == "hub" else ()
    with on_hub(*options) as (_, environment):
        assert environment.hub is not None
        lost = other = 0.0
        if how == "subscriber":
            with environment.script("number_subscriber.py", str(count)) as subscriber:
                subscriber.line()
                before = environment.hub.cpu_seconds
                _publish(environment, count)
                received, seconds = subscriber.line().split()
                used = environment.hub.cpu_seconds - before
                lost, other = count - int(received), float(seconds)
        elif how == "node":
            with _running(environment, "record", "-O", str(path), "-L", "0", TOPIC) as recorder:
                _wait_for_subscriber(environment)
                before, own = environment.hub.cpu_seconds, cpu_seconds(recorder.pid)
                _publish(environment, count)
                used = environment.hub.cpu_seconds - before
                other = cpu_seconds(recorder.pid) - own
            lost = count - _count(path)
        else:
            before = environment.hub.cpu_seconds
            _publish(environment, count)
            time.sleep(0.2)  # What waits for the disk is part of the work.
            used = environment.hub.cpu_seconds - before
    if how == "hub":
        [path] = (folder / "hub").iterdir()
        lost = count - _count(path)
        path.unlink()
    return Recorded(used / count * 1e6, other / count * 1e6, round(lost))


def _publish(environment: Environment, count: int) -> None:
    with environment.script("number_publisher.py", str(count), str(HZ)) as publisher:
        publisher.line()


def _count(path: Path) -> int:
    with open_reader(path) as bag:
        ids = {each.id for each in bag.connections if each.topic == TOPIC}
        return sum(count for id_, count in bag.counts.items() if id_ in ids)


# Playing.


def _measure_playing(folder: Path, plan: Plan, report: Report) -> None:
    rows = []
    for factor in (1, FAST):
        seconds = plan.seconds * (1 if plan.quick else 3)
        runs = [_play(folder, factor, seconds) for _ in range(1 if plan.quick else 3)]
        jitter, drift = (Repeated.of(each) for each in zip(*runs, strict=True))
        report.record("playing", rate=factor, jitter_ms=jitter.median, drift=drift.median)
        what = f"playing at -r {factor}"
        verdicts = (
            report.check(HUB, f"{what}, p99 of jitter", jitter.median, LIMIT_JITTER_MS, " ms"),
            report.check(HUB, f"{what}, drift", drift.median, LIMIT_DRIFT_PERCENT, " %"),
        )
        rows.append((f"-r {factor}", f"{jitter}", f"{drift}", ", ".join(verdicts)))
    report.table(
        f"Playing {PLAY_HZ:,} messages per second of the bag: p99 of the jitter in ms and drift "
        "in percent, minimum (median)",
        ("rate", "jitter", "drift", "limits"),
        rows,
    )
    size = QUICK_BAG_BYTES if plan.quick else BAG_BYTES
    memory = _memory(folder, size)
    verdict = report.check(HUB, "memory of a player", memory, LIMIT_MEMORY_MB, " MB")
    report.record("playing large", bytes=size, memory_mb=memory)
    report.table(
        "Playing a large bag without waiting: peak memory of the player",
        ("bag", "memory", "limit"),
        [(f"{size / 1e6:,.0f} MB", f"{memory:.0f} MB", verdict)],
    )


def _play(folder: Path, factor: int, seconds: float) -> tuple[float, float]:
    """Play a bag and record that; return the p99 of the jitter in ms, and the drift in percent."""
    source, target = folder / "source.bag", folder / "target.bag"
    count = round(PLAY_HZ * seconds * factor)
    with open_writer(source) as bag:
        connection = bag.connection(TOPIC, *_INT32, callerid="/bench")
        for number in range(count):
            data = number.to_bytes(4, "little")
            bag.write(connection, _START + number * 10**9 // PLAY_HZ, data)
    with (
        on_hub() as (_, environment),
        _running(environment, "record", "-O", str(target), "-L", "0", TOPIC),
    ):
        _wait_for_subscriber(environment)
        with _running(environment, "play", str(source), "-r", str(factor), "-q") as player:
            player.wait()
    with open_reader(target) as bag:
        times = [received for _, received, _ in bag.messages()]
    if len(times) != count:
        raise BenchError(f"{count - len(times)} of {count} messages of a playback were lost")
    late = [
        received - times[0] - number * 10**9 // PLAY_HZ / factor
        for number, received in enumerate(times)
    ]
    middle = sorted(late)[count // 2]
    off = sorted(abs(each - middle) for each in late)
    lasted = (count - 1) * 1e9 / PLAY_HZ / factor
    tenth = max(1, count // 10)
    drift = sum(late[-tenth:]) / tenth - sum(late[:tenth]) / tenth
    return off[int(count * 0.99)] / 1e6, abs(drift) / lasted * 100


def _memory(folder: Path, size: int) -> float:
    """Return the peak memory of a player of a large bag, in MB."""
    path = folder / "large.bag"
    with open_writer(path) as bag:
        connection = bag.connection(TOPIC, *_BYTES, callerid="/bench")
        data = bytes(8) + (LARGE - 12).to_bytes(4, "little") + bytes(LARGE - 12)
        for number in range(size // LARGE):
            bag.write(connection, _START + number * 10**6, data)
    peak = 0.0
    with on_hub() as (_, environment):
        with _running(environment, "play", str(path), "-q", "-i") as player:
            while player.poll() is None:
                peak = max(peak, _resident(player.pid))
                time.sleep(0.01)
        if player.returncode:
            raise BenchError("fibws bag play has failed")
    path.unlink()
    return peak


def _resident(pid: int) -> float:
    """Return the peak memory of a process in MB; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    found = [line.split()[1] for line in lines if line.startswith("VmHWM")]
    return int(found[0]) * 1024 / 1e6 if found else 0.0


# Programs.


@contextmanager
def _running(
    environment: Environment, command: str, *words: str
) -> Iterator[subprocess.Popen[bytes]]:
    """Run ``fibws bag`` until the end of the block, then as if by Ctrl-C."""
    process = subprocess.Popen(
        [sys.executable, "-m", "fibws", "bag", command, *words],
        env=environment.variables,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.send_signal(2)
        watchdog = threading.Timer(10 * STOP_SECONDS, process.kill)
        watchdog.start()
        process.wait()
        watchdog.cancel()


def _wait_for_subscriber(environment: Environment) -> None:
    """Wait until the recorder has subscribed to the topic."""
    words = [sys.executable, "-m", "fibws", "topic", "info", TOPIC]
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        found = subprocess.run(
            words, env=environment.variables, capture_output=True, text=True, check=False
        )
        if "record" in found.stdout:
            return
    raise BenchError("fibws bag record has not subscribed")
