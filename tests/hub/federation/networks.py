"""Machines with hubs: network namespaces with cables to a switch, which the tests make themselves.

They need root and Linux, and vanish with the process. The nodes of a test run in the test's own
process, outside of all namespaces: they reach each hub by `Machine.url`, which goes around the
cables.
"""

from __future__ import annotations

import asyncio
import ctypes
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import AsyncIterator, Awaitable, Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import AsyncExitStack, suppress
from pathlib import Path
from typing import Any, Self

import pytest
from patience import PATIENCE

ROOT = Path(__file__).parents[3]
PORT = 9090
ZENOH_PORT = 7447
_CLONE_NEWNET = 0x40000000
WITH_LEASE = """
from fibws.hub import zenoh_session
from fibws.hub.__main__ import command
from fibws.hub.federation import link
link.LEASE = zenoh_session.LEASE = {}
command()
"""

StartMachine = Callable[..., Awaitable["Machine"]]


class _Namespace:
    """A network namespace, which lasts as long as its thread."""

    def __init__(self) -> None:
        """Make it; raise `OSError` if that is not allowed."""
        self._thread = ThreadPoolExecutor(1)
        try:
            self._thread.submit(_unshare).result()
            number = self._thread.submit(threading.get_native_id).result()
        except OSError:
            self.close()
            raise
        self.path = f"/proc/{os.getpid()}/task/{number}/ns/net"
        self.ip("link", "set", "lo", "up")

    def run(self, *words: str) -> None:
        """Run a command there."""
        command = ["nsenter", f"--net={self.path}", *words]
        done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode:
            raise OSError(f"{' '.join(words)}: {done.stderr.strip()}")

    def ip(self, *words: str) -> None:
        """Run ``ip`` there."""
        self.run("ip", *words)

    def socket(self) -> socket.socket:
        """Return a TCP socket of this namespace."""
        return self._thread.submit(socket.socket).result()

    def close(self) -> None:
        """End it."""
        self._thread.shutdown()


def _unshare() -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(_CLONE_NEWNET):
        raise OSError(ctypes.get_errno(), "network namespaces are not allowed")


class Switch:
    """An Ethernet switch."""

    def __init__(self) -> None:
        """Make it; raise `OSError` if that is not allowed."""
        self._inside = _Namespace()
        self._inside.ip("link", "add", "name", "bridge", "type", "bridge")
        self._inside.ip("link", "set", "bridge", "up")
        self._ports = 0

    def connect(self, machine: _Namespace) -> tuple[str, str]:
        """Connect a machine's ``eth0``; return the name of the port and the machine's address."""
        self._ports += 1
        port, address = f"port{self._ports}", f"10.0.0.{self._ports}"
        inside = self._inside
        inside.ip(
            *("link", "add", "name", port, "type", "veth"),
            *("peer", "name", "eth0", "netns", machine.path),
        )
        inside.ip("link", "set", port, "master", "bridge", "up")
        machine.ip("address", "add", f"{address}/24", "dev", "eth0")
        machine.ip("link", "set", "eth0", "up")
        return port, address

    def set_port(self, port: str, state: str) -> None:
        """Switch a port on (``up``) or off (``down``)."""
        self._inside.ip("link", "set", port, state)

    def set_rate(self, port: str, rate: str) -> None:
        """Limit what a port sends to its machine, to a rate such as ``10mbit``."""
        _set_rate(self._inside, port, rate)

    def close(self) -> None:
        """Remove it."""
        self._inside.close()


class Machine:
    """A machine, and the hub that runs on it.

    Attributes:
        address: what other machines join.
        url: what nodes of the test connect to.
        log: the lines that the hub has logged.
    """

    def __init__(self, switch: Switch) -> None:
        self._switch = switch
        self._inside = _Namespace()
        self._port, self._host = switch.connect(self._inside)
        self._process: asyncio.subprocess.Process | None = None
        self._reader: asyncio.Task[None] | None = None
        self._server: asyncio.Server | None = None
        self._logged = asyncio.Event()
        self.address = f"ws://{self._host}:{PORT}"
        self.host = self._host
        self.url = ""
        self.log: list[str] = []

    async def start(
        self, name: str, *flags: str, lease: float | None = None, **variables: str
    ) -> Self:
        """Start a hub, and wait until it listens.

        Args:
            lease: seconds of silence after which a hub counts as lost; None for the usual ones.
        """
        hub = ("-m", "fibws.hub") if lease is None else ("-c", WITH_LEASE.format(lease))
        environment = {key: value for key, value in os.environ.items() if "FIBWS" not in key}
        self._process = await asyncio.create_subprocess_exec(
            *("nsenter", f"--net={self._inside.path}", sys.executable, *hub),
            *("--host", "0.0.0.0", "--port", str(PORT), "--hub-name", name, *flags),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            cwd=ROOT,
            env={**environment, **variables},
        )
        self._reader = asyncio.create_task(self._read(self._process))
        await self.logged(f":{PORT}")
        if self._server is None:
            self._server = await asyncio.start_server(self._forward, "127.0.0.1", 0)
            self.url = "ws://{}:{}".format(*self._server.sockets[0].getsockname())
        return self

    async def _read(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdout is not None
        async for line in process.stdout:
            self.log.append(line.decode().rstrip())
            self._logged.set()

    async def logged(self, pattern: str, count: int = 1) -> list[str]:
        """Wait until the hub has logged so many lines that match; return them."""
        try:
            async with asyncio.timeout(PATIENCE):
                while len(found := [line for line in self.log if re.search(pattern, line)]) < count:
                    self._logged.clear()
                    await self._logged.wait()
        except TimeoutError:
            raise AssertionError(f"the hub has not logged {pattern!r}: {self.log}") from None
        return found

    async def _forward(self, near: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Connect a node of the test to the hub."""
        loop = asyncio.get_running_loop()
        inside = self._inside.socket()
        inside.setblocking(False)
        try:
            await loop.sock_connect(inside, ("127.0.0.1", PORT))
        except OSError:
            inside.close()
            writer.close()
            return
        far, other = await asyncio.open_connection(sock=inside)
        ways = [asyncio.create_task(_copy(near, other)), asyncio.create_task(_copy(far, writer))]
        try:
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for way in ways:
                way.cancel()
            other.close()
            writer.close()

    # What happens to a machine.

    def pull(self) -> None:
        """Pull its cable."""
        self._switch.set_port(self._port, "down")

    def plug(self) -> None:
        """Plug its cable in again."""
        self._switch.set_port(self._port, "up")

    def slow(self, rate: str) -> None:
        """Limit its cable to a rate such as ``10mbit``, both ways."""
        _set_rate(self._inside, "eth0", rate)
        self._switch.set_rate(self._port, rate)

    async def kill(self) -> None:
        """Kill its hub, as ``kill -9`` does."""
        assert self._process is not None
        self._process.kill()
        await self._end()

    async def stop(self) -> None:
        """Stop its hub, and remove the machine."""
        if self._process is not None and self._process.returncode is None:
            self._process.send_signal(signal.SIGINT)
        await self._end()
        if self._server is not None:
            self._server.close()
        self._inside.close()

    async def _end(self) -> None:
        if self._process is not None and self._reader is not None:
            async with asyncio.timeout(PATIENCE):
                await self._process.wait()
                await self._reader


async def _copy(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    with suppress(OSError):
        while data := await reader.read(1 << 18):
            writer.write(data)
            await writer.drain()


def _set_rate(inside: _Namespace, device: str, rate: str) -> None:
    qdisc = ("tc", "qdisc", "replace", "dev", device, "root")
    inside.run(*qdisc, "tbf", "rate", rate, "burst", "32kb", "latency", "20ms")


@pytest.fixture
async def switch() -> AsyncIterator[Switch]:
    """A switch; skips the test where network namespaces are not allowed."""
    for program in ("ip", "tc", "nsenter"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} not found")
    try:
        switch = Switch()
    except OSError as error:
        pytest.skip(f"no network namespaces: {error}")
    yield switch
    switch.close()


@pytest.fixture(params=["websocket"])
async def start_machine(
    switch: Switch, request: pytest.FixtureRequest
) -> AsyncIterator[StartMachine]:
    """Starts a hub on a machine of its own, which joins those of other machines.

    Parameterized with ``zenoh`` it joins them over that.
    """
    is_zenoh = request.param == "zenoh"
    if is_zenoh:
        pytest.importorskip("zenoh")
    async with AsyncExitStack() as stack:

        async def start(name: str, *others: Machine, flags: Any = (), **options: Any) -> Machine:
            machine = Machine(switch)
            stack.push_async_callback(machine.stop)
            join = [word for other in others for word in ("--join", other.address)]
            if is_zenoh:
                join = ["--zenoh-listen", f"tcp/0.0.0.0:{ZENOH_PORT}"]
                join += (
                    word
                    for other in others
                    for word in ("--zenoh", f"tcp/{other.host}:{ZENOH_PORT}")
                )
            return await machine.start(name, *join, *flags, **options)

        yield start
