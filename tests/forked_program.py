"""The server of `fork_server`: has fibws's modules loaded, and forks a child for each program.

A request consists of file descriptors on the socket of the server: a socket for the program, and
its standard input, output and error. The program's socket carries the `Request` to the server, then
the process id and the exit code back. The end of the server's socket ends the server.
"""

from __future__ import annotations

import atexit
import builtins
import contextlib
import gc
import importlib
import io
import json
import os
import pkgutil
import runpy
import select
import signal
import site
import socket
import struct
import sys
import threading
import time
import traceback
import warnings
from dataclasses import asdict, dataclass
from importlib.machinery import BuiltinImporter, SourceFileLoader
from pathlib import Path
from types import ModuleType, TracebackType
from typing import Any, NoReturn, TextIO

NUMBER = struct.Struct("!q")
"""What the server sends over a program's socket: its process id, later its exit code."""
FIBWS = Path(__file__).parents[1] / "fibws"
UNLOADED = ("fibws.ros1.python", "fibws.ros1.fallback", "fibws.hub.zenoh_session")
"""rospy and its kin read the command line when imported; the other module starts threads."""


@dataclass(frozen=True)
class Request:
    """A program to run.

    Args:
        kind: ``-m`` (a module), ``-c`` (a text), or ``""`` (a script).
        target: the module, text or script.
        arguments: the program's arguments.
        words: the whole command line, without Python itself.
        warnings: the actions of ``-W``.
        unbuffered: whether ``-u`` is among the options.
        folder: the working directory.
        environment: all environment variables.
    """

    kind: str
    target: str
    arguments: list[str]
    words: list[str]
    warnings: list[str]
    unbuffered: bool
    folder: str
    environment: dict[str, str]

    def send(self, connection: socket.socket) -> None:
        """Write the request."""
        text = json.dumps(asdict(self)).encode()
        connection.sendall(NUMBER.pack(len(text)) + text)

    @classmethod
    def receive(cls, connection: socket.socket) -> Request:
        """Read a request."""
        length = receive_number(connection)
        if length is None:
            raise EOFError("the request is missing")
        return cls(**json.loads(connection.recv(length, socket.MSG_WAITALL)))


def receive_number(connection: socket.socket) -> int | None:
    """Read a number; None if the connection has ended."""
    try:
        data = connection.recv(NUMBER.size, socket.MSG_WAITALL)
    except ConnectionResetError:
        return None
    if len(data) < NUMBER.size:
        return None
    number: int = NUMBER.unpack(data)[0]
    return number


class Server:
    """A process with loaded modules, and the programs that it has forked.

    Args:
        requests: the socket to the process that wants programs.
    """

    def __init__(self, requests: socket.socket) -> None:
        self._requests = requests
        self._children: dict[int, socket.socket] = {}
        self._path = sys.path[1:]
        _load()
        # The collector of a program need not look at these objects.
        gc.collect()
        gc.freeze()

    def run(self) -> tuple[Request, list[int]] | None:
        """Serve requests; return None at the end, and in a child, the request and its streams."""
        waking, woken = socket.socketpair()
        waking.setblocking(False)
        woken.setblocking(False)
        signal.set_wakeup_fd(waking.fileno())
        # Ctrl-C in a terminal is sent to this process, too.
        for number in (signal.SIGCHLD, signal.SIGINT):
            signal.signal(number, lambda *_: None)
        while True:
            ready, _, _ = select.select([self._requests, woken], [], [])
            if woken in ready:
                woken.recv(4096)
                self._report_ends()
            if self._requests in ready:
                _, received, _, _ = socket.recv_fds(self._requests, 1, 4)
                if not received:
                    self._kill()
                    return None
                connection = socket.socket(fileno=received[0])
                request = Request.receive(connection)
                # A signal for the child must wait until the child has its own handlers.
                mask = signal.pthread_sigmask(signal.SIG_SETMASK, signal.valid_signals())
                pid = os.fork()
                if not pid:
                    signal.set_wakeup_fd(-1)
                    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                    signal.signal(signal.SIGINT, signal.default_int_handler)
                    sockets = [self._requests, waking, woken, connection, *self._children.values()]
                    for each in sockets:
                        each.close()
                    self._children.clear()
                    signal.pthread_sigmask(signal.SIG_SETMASK, mask)
                    return request, received[1:]
                signal.pthread_sigmask(signal.SIG_SETMASK, mask)
                for stream in received[1:]:
                    os.close(stream)
                self._children[pid] = connection
                _send_number(connection, pid)

    def _report_ends(self) -> None:
        for pid in list(self._children):
            ended, status = os.waitpid(pid, os.WNOHANG)
            if ended:
                connection = self._children.pop(pid)
                _send_number(connection, os.waitstatus_to_exitcode(status))
                connection.close()

    def _kill(self) -> None:
        for pid in self._children:
            os.kill(pid, signal.SIGKILL)
        for pid, connection in self._children.items():
            os.waitpid(pid, 0)
            connection.close()

    def prepare(self, request: Request, streams: list[int]) -> None:
        """Give this process all that a new interpreter takes from its surroundings."""
        for number, stream in enumerate(streams):
            os.dup2(stream, number)
            os.close(stream)
        os.chdir(request.folder)
        os.environ.clear()
        os.environ.update(request.environment)
        time.tzset()
        sys.dont_write_bytecode = bool(os.environ.get("PYTHONDONTWRITEBYTECODE"))
        _open_streams(request.unbuffered or bool(os.environ.get("PYTHONUNBUFFERED")))
        sys.warnoptions[:] = request.warnings
        for action in request.warnings:
            warnings.simplefilter(action)  # type: ignore[arg-type]
        if "numpy.random" in sys.modules:  # Python's own generator does so in each child.
            sys.modules["numpy.random"].seed()
        sys.orig_argv[:] = [sys.executable, *request.words]
        sys.argv[:] = [request.kind or request.target, *request.arguments]
        first = {
            "-m": request.folder,
            "-c": "",
            "": os.path.dirname(os.path.realpath(request.target)),
        }
        inherited = os.environ.get("PYTHONPATH", "")
        folders = [os.path.abspath(each) for each in inherited.split(os.pathsep) if each]
        sys.path[:] = [first[request.kind], *dict.fromkeys([*folders, *self._path])]
        importlib.invalidate_caches()
        if any(os.path.isfile(os.path.join(each, "sitecustomize.py")) for each in folders):
            sys.modules.pop("sitecustomize", None)
            site.execsitecustomize()


def _send_number(connection: socket.socket, number: int) -> None:
    with contextlib.suppress(OSError):  # Nobody waits for it.
        connection.sendall(NUMBER.pack(number))


def _load() -> None:
    """Import all of fibws."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for module in pkgutil.walk_packages([os.fspath(FIBWS)], "fibws."):
            name = module.name
            if not name.startswith(UNLOADED) and not name.endswith("__main__"):
                with contextlib.suppress(ModuleNotFoundError):  # An extra may not be installed.
                    importlib.import_module(name)


def _open_streams(unbuffered: bool) -> None:
    """Open the standard streams as Python does."""
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        old: TextIO = getattr(sys, f"__{name}__")
        raw = io.FileIO(number, mode, closefd=False)
        raw.name = f"<{name}>"
        buffer: Any = raw
        if mode == "r":
            buffer = io.BufferedReader(raw)
        elif not unbuffered:
            buffer = io.BufferedWriter(raw)
        stream: Any = io.TextIOWrapper(
            buffer,
            old.encoding,
            old.errors,
            newline="\n",
            line_buffering=name == "stderr" or raw.isatty(),
            write_through=mode == "w" and unbuffered,
        )
        stream.mode = mode
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)


def run(request: Request, main: ModuleType) -> None:
    """Run a program as the module ``main``, which has the name ``__main__``."""
    vars(main)["__builtins__"] = builtins
    sys.modules["__main__"] = main
    if request.kind == "-m":
        _forget(request.target)
        runpy._run_module_as_main(request.target)  # type: ignore[attr-defined]
        return
    if request.kind == "-c":
        text: str | bytes = request.target
        file = "<string>"
        main.__loader__ = BuiltinImporter
    else:
        file = request.target
        try:
            text = Path(file).read_bytes()
        except OSError as error:
            where = os.path.abspath(file)
            reason = f"[Errno {error.errno}] {error.strerror}"
            print(f"{sys.executable}: can't open file {where!r}: {reason}", file=sys.stderr)
            sys.exit(2)
        main.__loader__ = SourceFileLoader("__main__", file)
        main.__file__ = os.path.abspath(file)
    exec(compile(text, file, "exec", dont_inherit=True), vars(main))


def _forget(module: str) -> None:
    """Unload a module that is about to run as the program."""
    names = [module, f"{module}.__main__"]
    if module in sys.modules and hasattr(sys.modules[module], "__path__"):
        names = names[1:]
    for name in names:
        if sys.modules.pop(name, None) is not None:
            parent, _, child = name.rpartition(".")
            vars(sys.modules[parent]).pop(child, None)


def end(error: BaseException | None, main: ModuleType) -> NoReturn:
    """End this process as Python does.

    Python would also unload all modules, which takes most of the time of a short program.
    """
    code = 0
    is_interrupted = isinstance(error, KeyboardInterrupt)
    if isinstance(error, SystemExit):
        code = _exit_code(error)
    elif error is not None:
        code = 1
        shown = _without_this_file(error.__traceback__)
        try:
            sys.excepthook(type(error), error.with_traceback(shown), shown)
        except SystemExit as exit_:
            code, is_interrupted = _exit_code(exit_), False
    error = None
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    code = code if _flush() else 120
    # For the complaints about what a program has left open.
    vars(main).clear()
    gc.collect()
    _flush()
    if is_interrupted:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGINT)
    os._exit(code & 0xFF)


def _exit_code(error: SystemExit) -> int:
    if error.code is None:
        return 0
    if isinstance(error.code, int):
        return error.code
    print(error.code, file=sys.stderr, flush=True)
    return 1


def _flush() -> bool:
    """Write what is buffered; return whether that of standard output was possible."""
    done = True
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None and not stream.closed:
                stream.flush()
        except Exception:
            if stream is sys.stdout:
                done = False
                with contextlib.suppress(Exception):
                    traceback.print_exc()
    return done


def _without_this_file(found: TracebackType | None) -> TracebackType | None:
    while found is not None and found.tb_frame.f_code.co_filename == __file__:
        found = found.tb_next
    return found


def main() -> None:
    """Serve requests on standard input, which is a socket."""
    with socket.socket(fileno=os.dup(0)) as requests:
        server = Server(requests)
        forked = server.run()
    if forked is None:
        return
    main = ModuleType("__main__")
    error = None
    try:
        server.prepare(*forked)
        run(forked[0], main)
    except BaseException as caught:
        error = caught
    end(error, main)


if __name__ == "__main__":
    main()
