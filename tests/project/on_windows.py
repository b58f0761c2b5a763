"""Run a module of fibws as if on Windows, as far as that is possible elsewhere.

    python tests/project/on_windows.py MODULE ARGUMENTS...

What Windows lacks is missing: modules such as fcntl, functions and constants of os, signal, socket
and time, and the handlers of signals, files and Unix sockets that event loops have. `sys.platform`
is win32. `os.name` is not nt: paths would be those of Windows. Other packages were imported before,
so only fibws meets what is missing.
"""

from __future__ import annotations

import asyncio
import importlib
import os
import pkgutil
import runpy
import select
import signal
import socket
import subprocess
import sys
import time
import traceback
import types
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

PACKAGE = Path(__file__).parents[2] / "fibws"
SCRIPTS_MODULES = PACKAGE / "ros1" / "python"
"""The folder of the modules for rospy scripts, such as rospy."""

MODULES = ["_curses", "_posixsubprocess", "crypt", "curses", "fcntl", "grp", "nis", "posix", "pty"]
MODULES += ["pwd", "readline", "resource", "spwd", "syslog", "termios", "tty", "uvloop"]
SIGNALS = {"SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM", "SIG_DFL", "SIG_IGN"}
"""The signals that Windows has."""
OTHERS_OF_SIGNAL = ["alarm", "getitimer", "pause", "pthread_kill", "pthread_sigmask", "setitimer"]
OTHERS_OF_SIGNAL += ["siginterrupt", "sigpending", "sigtimedwait", "sigwait", "sigwaitinfo"]
OF_OS = ["EX_OK", "O_ASYNC", "O_CLOEXEC", "O_DIRECTORY", "O_DSYNC", "O_NDELAY", "O_NOCTTY"]
OF_OS += ["O_NOFOLLOW", "O_NONBLOCK", "O_SYNC", "chown", "chroot", "confstr", "ctermid", "fchmod"]
OF_OS += ["fchown", "fdatasync", "fork", "forkpty", "fstatvfs", "getegid", "geteuid", "getgid"]
OF_OS += ["getgrouplist", "getgroups", "getloadavg", "getpgid", "getpgrp", "getpriority", "getsid"]
OF_OS += ["getuid", "initgroups", "killpg", "lchown", "lockf", "memfd_create", "mkfifo", "mknod"]
OF_OS += ["nice", "openpty", "pathconf", "pidfd_open", "pipe2", "posix_fallocate", "posix_spawn"]
OF_OS += ["pread", "preadv", "pwrite", "pwritev", "readv", "register_at_fork", "sched_getaffinity"]
OF_OS += ["sched_yield", "sendfile", "setegid", "seteuid", "setgid", "setpgid", "setsid", "setuid"]
OF_OS += ["splice", "statvfs", "sync", "sysconf", "tcgetpgrp", "tcsetpgrp", "ttyname", "uname"]
OF_OS += ["wait", "wait3", "wait4", "waitid", "writev", "WIFSIGNALED", "WTERMSIG"]
OF_SOCKET = ["AF_UNIX", "MSG_DONTWAIT", "MSG_NOSIGNAL", "SCM_RIGHTS", "SOCK_CLOEXEC", "TCP_INFO"]
OF_SOCKET += ["SOCK_NONBLOCK", "SO_REUSEPORT", "TCP_USER_TIMEOUT", "fromfd"]
OF_TIME = ["CLOCK_MONOTONIC", "CLOCK_REALTIME", "clock_gettime", "clock_gettime_ns", "tzset"]
IMPORTED_BEFORE = ["click", "concurrent.futures", "importlib.metadata", "rich.live", "tempfile"]
IMPORTED_BEFORE += ["rich.table", "rich.traceback", "ssl", "unittest", "uuid", "webbrowser"]
IMPORTED_BEFORE += ["fibws.client.hub_client", "fibws.msg.std_msgs", "fibws.node", "zoneinfo"]
"""Imports the other packages that are needed; fibws itself is imported again."""


class WindowsLoop(asyncio.SelectorEventLoop):
    """An event loop that lacks what those of Windows lack."""


def _not_implemented(*arguments: Any, **options: Any) -> NoReturn:
    raise NotImplementedError


for _name in ("add_signal_handler", "remove_signal_handler", "add_reader", "add_writer"):
    setattr(WindowsLoop, _name, _not_implemented)
for _name in ("create_unix_server", "create_unix_connection"):
    setattr(WindowsLoop, _name, _not_implemented)


class WindowsPolicy(asyncio.DefaultEventLoopPolicy):
    """Makes such event loops for `asyncio.run`."""

    def new_event_loop(self) -> WindowsLoop:
        return WindowsLoop()


def become_windows() -> None:
    """Remove what Windows lacks from this process, and add what it has."""
    socket.socketpair = partial(socket.socketpair, socket.AF_UNIX)
    _remove(os, OF_OS)
    _remove(socket, OF_SOCKET)
    _remove(time, OF_TIME)
    _remove(select, ["epoll", "kqueue", "poll"])
    signals = [name for name in vars(signal) if name.startswith("SIG")]
    _remove(signal, [name for name in signals if name not in SIGNALS] + OTHERS_OF_SIGNAL)
    for name in MODULES:
        sys.modules[name] = None  # type: ignore[assignment]  # An import fails.
    vars(signal).update(SIGBREAK=21, CTRL_C_EVENT=0, CTRL_BREAK_EVENT=1)
    vars(subprocess).update(CREATE_NEW_PROCESS_GROUP=0x200, CREATE_NO_WINDOW=0x8000000)
    vars(os).update(kill=_kill, O_BINARY=0, startfile=None)
    sys.modules["msvcrt"] = _msvcrt()
    sys.platform = "win32"
    asyncio.set_event_loop_policy(WindowsPolicy())
    # The background jobs of a shell, and all that they start, ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def _remove(module: types.ModuleType, names: list[str]) -> None:
    for name in names:
        vars(module).pop(name, None)


def _kill(pid: int, number: int, kill: Callable[[int, int], None] = os.kill) -> None:
    if number == 0:
        raise AssertionError("os.kill(pid, 0) sends Ctrl-C on Windows")
    kill(pid, number)


def _msvcrt() -> types.ModuleType:
    module = types.ModuleType("msvcrt")
    vars(module).update(
        LK_LOCK=1, LK_NBLCK=2, LK_UNLCK=0, locking=lambda *_: None, kbhit=lambda: False
    )
    return module


def forget_fibws() -> None:
    """Remove fibws's modules, so that they are imported again."""
    for name, module in [*sys.modules.items()]:
        if str(getattr(module, "__file__", None) or "").startswith(str(PACKAGE)):
            del sys.modules[name]


def all_modules() -> Iterator[str]:
    """Yield the names of all modules of fibws, and of those for rospy scripts."""
    places = [([str(PACKAGE)], "fibws."), ([str(SCRIPTS_MODULES)], "")]
    for path, prefix in places:
        for found in pkgutil.walk_packages(path, prefix, onerror=lambda name: None):
            if found.name != "sitecustomize" and not found.name.startswith("fibws.ros1.python"):
                yield found.name


def import_all() -> None:
    """Import all modules as on Windows; exit with the errors of those that fail only there."""
    sys.path.insert(0, str(SCRIPTS_MODULES))
    names = [name for name in all_modules() if not _error_of_import(name)]
    forget_fibws()
    become_windows()
    errors = [error for name in names if (error := _error_of_import(name))]
    print(f"{len(names)} modules")
    if errors:
        sys.exit("\n".join(errors))


def _error_of_import(name: str) -> str:
    try:
        importlib.import_module(name)
    except BaseException:
        return f"{name}:\n{traceback.format_exc(limit=-3)}"
    return ""


def main() -> None:
    """Run the module that the command line names; ``all`` imports all of them."""
    sys.path.insert(0, str(PACKAGE.parent))
    module = sys.argv[1]
    if module == "all":
        import_all()
        return
    del sys.argv[0]
    for name in (*IMPORTED_BEFORE, module):
        importlib.import_module(name)
    forget_fibws()
    become_windows()
    runpy.run_module(module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
