"""Forked programs behave as programs of a new interpreter."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import fork_server
import pytest

pytestmark = pytest.mark.skipif(not fork_server.CAN_FORK, reason="this system cannot fork")

PROGRAMS = {
    "prints": "print('out'); import sys; print('err', file=sys.stderr)",
    "exit code": "import sys; sys.exit(3)",
    "exit text": "import sys; sys.exit('a text')",
    "raises": "def f(): raise ValueError('wrong')\nf()",
    "raises in a thread": "import threading; threading.Thread(target=lambda: 1 / 0).start()",
    "Ctrl-C": "raise KeyboardInterrupt",
    "killed": "import os, signal; os.kill(os.getpid(), signal.SIGTERM)",
    "hook": "import sys\ndef hook(*_): raise SystemExit(4)\nsys.excepthook = hook\n1 / 0",
    "atexit": "import atexit, sys; atexit.register(print, 'ended'); sys.exit(1)",
    "thread": (
        "import threading as t; e = t.Event()\n"
        "t.Thread(target=lambda: (e.wait(), print('late'))).start(); print('main'); e.set()"
    ),
    "arguments": "import sys; print(sys.argv, sys.flags.dev_mode, __name__)",
    "input": "print(input().upper())",
    "folder": "import os, sys; print(os.getcwd(), sys.path[0])",
    "environment": "import os; print(os.environ['WORD'], os.getenv('WORD'), os.getenv('PATH'))",
    "warnings": "import warnings; warnings.warn('careful')",
    "state of fibws": "import fibws.msg, fibws.command_names as n; print(n._called_alias)",
    "signals": "import signal as s; print(s.getsignal(s.SIGINT), s.getsignal(s.SIGCHLD))",
    "open file": "open('/dev/null')",
    "encoding": "import sys; print(sys.stdout.encoding, sys.stdin.errors, 'ä')",
    "logging": "import logging; logging.warning('careful'); print(logging.getLogger().handlers)",
    "random": "import random; print(random.random() == random.random())",
}


class Ended(NamedTuple):
    """How a program has ended."""

    code: int
    out: str
    err: str


def run(process: subprocess.Popen[str]) -> Ended:
    out, err = process.communicate("some words\n", timeout=60)
    return Ended(process.returncode, out, err)


@pytest.mark.parametrize("options", [[], ["-W", "error"], ["-u"]], ids=str)
@pytest.mark.parametrize("name", PROGRAMS)
def test_program_does_as_in_a_new_interpreter(
    name: str, options: list[str], tmp_path: Path
) -> None:
    line = [*options, "-c", PROGRAMS[name], "one", "--two"]
    how: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    how |= {"env": {**os.environ, "WORD": "ä"}, "cwd": tmp_path, "text": True}
    forked = fork_server.popen(line, **how)
    assert isinstance(forked, fork_server.ForkedPopen)
    assert run(forked) == run(subprocess.Popen([sys.executable, *line], **how))


def test_module_starts_with_new_state_each_time(tmp_path: Path) -> None:
    (tmp_path / "counting.py").write_text(
        "import fibws as f; f.n = getattr(f, 'n', 0) + 1; print(f.n)"
    )
    for _ in range(2):
        process = fork_server.popen(["-m", "counting"], cwd=tmp_path, stdout=subprocess.PIPE)
        assert process.communicate(timeout=60)[0] == b"1\n"


@pytest.mark.parametrize(
    "variables", [{"PYTHONHASHSEED": "7"}, {"LANG": "C"}, {"FIBWS_INTERFACES": "/somewhere"}]
)
def test_variables_for_the_start_of_python_need_a_new_interpreter(
    variables: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(fork_server.ENVIRONMENT, "LANG", "de_DE.UTF-8")
    process = fork_server.popen(["-c", ""], env={**os.environ, **variables})
    assert not isinstance(process, fork_server.ForkedPopen)
    assert process.wait(60) == 0


async def test_programs_run_side_by_side_and_take_signals() -> None:
    waiting = "print('ready', flush=True); import signal; signal.pause()"
    programs = [await fork_server.start("-c", waiting) for _ in range(3)]
    assert len({program.pid for program in programs}) == 3
    for program in programs:
        assert program.stdout is not None
        assert await program.stdout.readline() == b"ready\n"
    programs[0].terminate()
    programs[1].kill()
    programs[2].send_signal(signal.SIGINT)
    async with asyncio.timeout(60):
        assert [await program.wait() for program in programs] == [-15, -9, -2]
        for program in programs:
            await program.communicate()


@pytest.mark.long
def test_programs_end_with_their_server() -> None:
    server = fork_server._Server()
    request = fork_server._request(["-c", "import signal; signal.pause()"], None, None)
    assert request is not None
    with open(os.devnull) as null:
        connection, pid = server.fork(request, [null.fileno()] * 3)
    with connection:
        server.stop()
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
