"""Starts Python programs as forks of a process that has fibws loaded.

A fork takes about a hundredth of the CPU time of a new interpreter that imports fibws. It behaves
as a new interpreter does, but for what is decided before the first import: a program gets a new
interpreter if its options or environment variables need one, or if the system cannot fork.

Tests of the start itself (which modules are loaded, ``python -P``, the command ``fibws``) use
`subprocess` and `asyncio.create_subprocess_exec`.
"""

from __future__ import annotations

import asyncio
import atexit
import os
import signal
import socket
import subprocess
import sys
import threading
from asyncio.base_subprocess import BaseSubprocessTransport
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from forked_program import Request, receive_number

try:
    import resource
except ImportError:  # Windows has no such limits.
    resource = None  # type: ignore[assignment]

CAN_FORK = hasattr(os, "fork") and hasattr(socket, "send_fds")


def _limits() -> tuple[int, int] | None:
    """Return the limits of open files of this process, which programs inherit."""
    return resource.getrlimit(resource.RLIMIT_NOFILE) if CAN_FORK else None


KNOWN = {"PYTHONPATH", "PYTHONUNBUFFERED", "PYTHONDONTWRITEBYTECODE"}
"""The variables for Python that a fork obeys; others must be as in this process."""
SIMPLE_ACTIONS = {"default", "error", "always", "ignore", "module", "once"}
ENVIRONMENT = dict(os.environ)
"""The variables of the server, before tests change them."""
LIMITS = _limits()
"""The limits of the server."""
PIPE = subprocess.PIPE
DEVNULL = subprocess.DEVNULL
STDOUT = subprocess.STDOUT


async def start(
    *words: str | Path,
    env: Mapping[str, str] | None = None,
    cwd: str | Path | None = None,
    stdin: Any = None,
    stdout: Any = PIPE,
    stderr: Any = PIPE,
) -> asyncio.subprocess.Process:
    """Start Python with these words, as `asyncio.create_subprocess_exec` does."""
    line = [os.fspath(word) for word in words]
    request = _request(line, env, cwd)
    if request is None:
        return await asyncio.create_subprocess_exec(
            sys.executable, *line, env=env, cwd=cwd, stdin=stdin, stdout=stdout, stderr=stderr
        )
    loop = asyncio.get_running_loop()
    protocol = asyncio.subprocess.SubprocessStreamProtocol(limit=2**16, loop=loop)
    waiter = loop.create_future()
    transport = _Transport(
        *(loop, protocol, line, False, stdin, stdout, stderr, 0), waiter, request=request
    )
    await waiter
    return asyncio.subprocess.Process(transport, protocol, loop)


def popen(
    words: Sequence[str | Path],
    *,
    env: Mapping[str, str] | None = None,
    cwd: str | Path | None = None,
    **options: Any,
) -> subprocess.Popen[Any]:
    """Start Python with these words.

    Args:
        words: the options, program and arguments.
        env: the environment variables; by default those of this process.
        cwd: the working directory; by default that of this process.
        options: the streams and their kinds, as of `subprocess.Popen`.
    """
    line = [os.fspath(word) for word in words]
    request = _request(line, env, cwd)
    if request is None:
        return subprocess.Popen([sys.executable, *line], env=env, cwd=cwd, **options)
    return ForkedPopen(request, **options)


def _request(
    words: list[str], env: Mapping[str, str] | None, cwd: str | Path | None
) -> Request | None:
    """Return the request for a program, or None if it needs a new interpreter."""
    environment = dict(os.environ if env is None else env)
    if not CAN_FORK or _limits() != LIMITS or _needs_new(environment) != _needs_new(ENVIRONMENT):
        return None
    actions: list[str] = []
    unbuffered = False
    rest = words[:]
    while rest:
        word = rest.pop(0)
        if word == "-u":
            unbuffered = True
        elif word == "-W" and rest and rest[0] in SIMPLE_ACTIONS:
            actions.append(rest.pop(0))
        elif (word in ("-m", "-c") and rest) or not word.startswith("-"):
            kind, target = (word, rest.pop(0)) if word.startswith("-") else ("", word)
            folder = os.path.abspath(cwd or os.getcwd())
            return Request(kind, target, rest, words, actions, unbuffered, folder, environment)
        else:
            break
    return None


def _needs_new(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that only a new interpreter reads."""
    found = {
        name: value
        for name, value in environment.items()
        if (name.startswith("PYTHON") and name not in KNOWN)
        # The packages in these folders may hide the loaded ones.
        or (name == "FIBWS_INTERFACES" and value)
    }
    locale = next(filter(None, map(environment.get, ("LC_ALL", "LC_CTYPE", "LANG"))), "C")
    # Python's streams are the same in all of these.
    return found | {"LANG": "C" if locale in ("C", "POSIX", "C.UTF-8", "C.utf8") else locale}


class ForkedPopen(subprocess.Popen[Any]):
    """A forked program, with all methods of `subprocess.Popen`."""

    def __init__(self, request: Request, **options: Any) -> None:
        self._request = request
        self.connection: socket.socket
        super().__init__([sys.executable, *request.words], **options)

    def _execute_child(self, *arguments: Any) -> None:
        *_, p2cread, p2cwrite, c2pread, c2pwrite, errread, errwrite = arguments[:16]
        streams = [
            given if given != -1 else number
            for number, given in enumerate((p2cread, c2pwrite, errwrite))
        ]
        try:
            self.connection, self.pid = _SERVER.fork(self._request, streams)
        finally:
            self._close_pipe_fds(  # type: ignore[attr-defined]
                p2cread, p2cwrite, c2pread, c2pwrite, errread, errwrite
            )
        self._child_created = True

    def _internal_poll(self, *_: Any, **__: Any) -> int | None:
        return self._receive(0)

    def _wait(self, timeout: float | None) -> int:
        code = self._receive(timeout)
        if code is None:
            assert timeout is not None
            raise subprocess.TimeoutExpired(self.args, timeout)
        return code

    def _receive(self, timeout: float | None) -> int | None:
        """Return the exit code, or None if the program still runs after this time."""
        if self.returncode is None:
            self.connection.settimeout(timeout)
            try:
                code = receive_number(self.connection)
            except (BlockingIOError, TimeoutError):
                return None
            self.connection.close()
            if code is None:
                print("The fork server has ended; killing its program", self.pid, file=sys.stderr)
                code = -signal.SIGKILL
                with suppress(ProcessLookupError):
                    os.kill(self.pid, signal.SIGKILL)
            self.returncode = code
        return self.returncode


class _Transport(BaseSubprocessTransport):
    """Connects a `ForkedPopen` with an event loop."""

    def _start(  # type: ignore[override]
        self,
        args: Any,
        shell: bool,
        stdin: Any,
        stdout: Any,
        stderr: Any,
        bufsize: int,
        *,
        request: Request,
    ) -> None:
        self._forked = process = ForkedPopen(
            request, stdin=stdin, stdout=stdout, stderr=stderr, bufsize=bufsize
        )
        self._proc = process
        # The process closes its own, maybe before the event loop has seen the end.
        self._connection = process.connection.dup()
        self._loop.add_reader(self._connection, self._poll)

    def _poll(self) -> None:
        code = self._forked.poll()
        if code is not None:
            self._loop.remove_reader(self._connection)
            self._connection.close()
            self._process_exited(code)


class _Server:
    """The server of this process, which starts with the first program."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._requests: socket.socket | None = None

    def fork(self, request: Request, streams: list[int]) -> tuple[socket.socket, int]:
        """Return the socket and process id of a new program."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                self._start()
            assert self._requests is not None
            ours, theirs = socket.socketpair()
            with theirs:
                socket.send_fds(self._requests, [b"."], [theirs.fileno(), *streams])
        request.send(ours)
        pid = receive_number(ours)
        if pid is None:
            ours.close()
            raise RuntimeError("the fork server has ended")
        return ours, pid

    def _start(self) -> None:
        self.stop()
        ours, theirs = socket.socketpair()
        kept = {
            name: value
            for name, value in ENVIRONMENT.items()
            if not name.startswith(("FIBWS", "ROS")) and name != "PYTHONPATH"
        }
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, os.fspath(Path(__file__).with_name("forked_program.py"))],
                stdin=theirs.fileno(),
                # Forked programs must not get the threads that numpy starts.
                env={**kept, "OPENBLAS_NUM_THREADS": "1"},
            )
        self._requests = ours

    def stop(self) -> None:
        """End the server and its programs."""
        if self._requests is not None:
            self._requests.close()
        if self._process is not None:
            self._process.wait()


_SERVER = _Server()
atexit.register(_SERVER.stop)
