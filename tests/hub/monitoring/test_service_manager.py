"""Messages to systemd, received by a socket that stands for it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from patience import PATIENCE

from fibws.hub.monitoring.service_manager import ServiceManager

from ..fakes import FakeClock


class Systemd:
    """Receives the datagrams of services."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(address.replace("@", "\0", 1))
        self._socket.settimeout(PATIENCE)

    def receive(self) -> dict[str, str]:
        """Return the values of the next message."""
        lines = self._socket.recv(4096).decode().splitlines()
        return dict(line.split("=", 1) for line in lines)

    def receive_until(self, name: str) -> dict[str, str]:
        """Return the next message that has this value."""
        while name not in (found := self.receive()):
            pass
        return found

    def is_silent(self) -> bool:
        """Return whether no message waits."""
        self._socket.setblocking(False)
        try:
            self._socket.recv(4096)
        except BlockingIOError:
            return True
        return False

    def close(self) -> None:
        self._socket.close()


@pytest.fixture(params=["path", "abstract"])
def systemd(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Systemd]:
    is_path = request.param == "path"
    systemd = Systemd(str(tmp_path / "notify") if is_path else f"@fibws-test-{os.getpid()}")
    yield systemd
    systemd.close()


def manager(clock: FakeClock, **environment: str) -> ServiceManager:
    return ServiceManager(clock, lambda: "2 clients", environment)


def test_ready_is_reported_with_a_status(systemd: Systemd) -> None:
    service = manager(FakeClock(), NOTIFY_SOCKET=systemd.address)
    service.ready()
    assert systemd.receive() == {"READY": "1", "STATUS": "2 clients"}
    service.close()


def test_watchdog_is_fed_twice_in_its_time(systemd: Systemd) -> None:
    clock = FakeClock()
    service = manager(clock, NOTIFY_SOCKET=systemd.address, WATCHDOG_USEC="20000000")
    service.ready()
    systemd.receive()
    assert systemd.receive()["WATCHDOG"] == "1"
    clock.advance(9.9)
    assert systemd.is_silent()
    clock.advance(0.2)
    assert not systemd.is_silent()
    service.ready()  # After a reload: it must not be fed twice as often.
    service.close()
    assert clock.timers == 0


@pytest.mark.parametrize(
    "variables",
    [
        {},
        {"WATCHDOG_USEC": "0"},
        {"WATCHDOG_USEC": "x"},
        {"WATCHDOG_USEC": "\u0663"},
        {"WATCHDOG_USEC": "9", "WATCHDOG_PID": "1"},
    ],
)
def test_without_a_watchdog_none_is_fed(systemd: Systemd, variables: dict[str, str]) -> None:
    clock = FakeClock()
    service = manager(clock, NOTIFY_SOCKET=systemd.address, **variables)
    service.ready()
    assert clock.timers == 0
    service.close()


def test_without_a_service_manager_nothing_happens() -> None:
    service = manager(FakeClock())
    service.ready()
    service.reloading()
    service.stopping()
    service.close()


def test_lost_service_manager_is_logged(
    systemd: Systemd, caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    service = manager(FakeClock(), NOTIFY_SOCKET=str(tmp_path / "nobody"))
    service.ready()
    assert "service manager" in caplog.text
    service.close()


def test_fault_is_logged_once_and_again_after_a_success(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    address = str(tmp_path / "notify")
    clock = FakeClock()
    service = manager(clock, NOTIFY_SOCKET=address, WATCHDOG_USEC="20000000")
    service.ready()
    clock.advance(30)
    assert len(caplog.records) == 1
    systemd = Systemd(address)
    clock.advance(10)
    systemd.close()
    clock.advance(20)
    assert len(caplog.records) == 2
    service.close()


def test_path_that_is_too_long_is_explained(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    service = manager(FakeClock(), NOTIFY_SOCKET=str(tmp_path / ("x" * 200)))
    service.ready()
    assert "too long" in caplog.text
    service.close()


def test_watchdog_of_a_microsecond_does_not_keep_the_hub_busy(systemd: Systemd) -> None:
    clock = FakeClock()
    service = manager(clock, NOTIFY_SOCKET=systemd.address, WATCHDOG_USEC="1")
    service.ready()
    for _ in ("READY", "WATCHDOG"):
        systemd.receive()
    clock.advance(0.005)
    assert systemd.is_silent()
    service.close()


def test_hub_reports_its_life_to_systemd(systemd: Systemd) -> None:
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("FIBWS_")
    } | {"NOTIFY_SOCKET": systemd.address, "WATCHDOG_USEC": "100000"}
    began = time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
    process = subprocess.Popen(
        [sys.executable, "-m", "fibws.hub", "--port", "0"],
        stdout=subprocess.DEVNULL,
        env=environment,
    )
    with process:
        try:
            ready = systemd.receive()
            assert ready["READY"] == "1" and "0 clients" in ready["STATUS"]
            for _ in range(3):
                assert systemd.receive_until("WATCHDOG")["WATCHDOG"] == "1"
            process.send_signal(signal.SIGHUP)
            reloading = systemd.receive_until("RELOADING")
            now = time.clock_gettime_ns(time.CLOCK_MONOTONIC) // 1000
            assert began < int(reloading["MONOTONIC_USEC"]) <= now
            systemd.receive_until("READY")
            process.terminate()
            systemd.receive_until("STOPPING")
            assert process.wait(PATIENCE) == 0
        finally:
            process.kill()
