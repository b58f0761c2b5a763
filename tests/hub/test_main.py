"""``python -m fibws.hub``: the hub as a program."""

from __future__ import annotations

import dataclasses
import json
import os
import re
import resource
import select
import shlex
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import fork_server
import pytest
from certificates import Authority
from certificates import authority as authority
from click.testing import CliRunner
from patience import PATIENCE
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from fibws import __version__
from fibws.hub import Settings
from fibws.hub.__main__ import _warn_of_mistakes, command
from fibws.hub.settings import flag_of


class Program:
    """A running hub and its output."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def first_line(self) -> str:
        """Return the line that it prints when it is ready."""
        assert self.process.stdout is not None
        assert select.select([self.process.stdout], [], [], PATIENCE)[0], "it prints nothing"
        return self.process.stdout.readline()

    def url(self) -> str:
        """Return the URL in its first line."""
        found = re.search(r"wss?://\S+:\d+", self.first_line())
        assert found is not None
        return found[0]

    def end(self) -> tuple[int, str, str]:
        """Wait for the hub's end; return its exit code and remaining output."""
        out, err = self.process.communicate(timeout=PATIENCE)
        return self.process.returncode, out, err


NOT_REPEATED = (
    "-c",
    "from fibws import exit_signals; from fibws.hub.__main__ import main; "
    "exit_signals.REPEAT = 0.0; main()",
)
"""A hub for which each signal is another one."""


@contextmanager
def running(*arguments: str, **environment: str) -> Iterator[Program]:
    """A hub in a process of its own; it does not outlive the block."""
    with running_as(("-m", "fibws.hub"), *arguments, **environment) as program:
        yield program


@contextmanager
def running_as(module: tuple[str, ...], *arguments: str, **environment: str) -> Iterator[Program]:
    """A hub that Python runs as these words say."""
    known = {name: value for name, value in os.environ.items() if not name.startswith("FIBWS_")}
    process = fork_server.popen(
        [*module, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=known | environment,
    )
    with process:
        try:
            yield Program(process)
        finally:
            if process.poll() is None:
                process.kill()


@pytest.mark.long
def test_hangup_reads_the_certificate_again(authority: Authority) -> None:
    certificate, key = authority.issue()
    files = ("--cert", str(certificate), "--key", str(key))
    with running("--port", "0", *files) as hub:
        url = hub.url()
        assert url.startswith("wss://")
        authority.issue(common_name="new")
        hub.process.send_signal(signal.SIGHUP)
        assert hub.process.stderr is not None
        line = hub.process.stderr.readline()
        assert "Reloaded: certificate replaced, valid until" in line
        port = int(url.rpartition(":")[2])
        with (
            socket.create_connection(("127.0.0.1", port)) as plain,
            authority.client().wrap_socket(plain, server_hostname="127.0.0.1") as tls,
        ):
            assert "'new'" in str(tls.getpeercert())
        hub.process.terminate()
        assert hub.end()[0] == 0


def test_closed_terminal_ends_the_hub() -> None:
    with_terminal = "import pty, sys; pty.spawn(sys.argv[1:])"
    command = [sys.executable, "-m", "fibws.hub", "--port", "0"]
    process = subprocess.Popen(
        [sys.executable, "-c", with_terminal, *command], stdout=subprocess.PIPE, text=True
    )
    with process:
        assert process.stdout is not None
        found = re.search(r"ws://\S+:\d+", process.stdout.readline())
        assert found is not None
        with connect(found[0]) as websocket:
            process.kill()  # The terminal's other end is gone.
            with pytest.raises(ConnectionClosed) as closed:
                websocket.recv(timeout=PATIENCE)
            assert closed.value.rcvd is not None and closed.value.rcvd.code == 1001


@pytest.mark.parametrize(
    ("number", "expected"),
    [
        (signal.SIGTERM, (1012, "service restart")),
        (signal.SIGINT, (1001, "the hub is shutting down")),
    ],
)
def test_signal_closes_clients_and_exits_with_0(
    number: signal.Signals, expected: tuple[int, str]
) -> None:
    with running("--port", "0") as hub, connect(hub.url()) as websocket:
        websocket.send('{"op":"nope"}')
        assert "Unknown operation: nope" in json.loads(websocket.recv(PATIENCE))["msg"]
        hub.process.send_signal(number)
        with pytest.raises(ConnectionClosed) as closed:
            websocket.recv(PATIENCE)
        code, out, err = hub.end()
    assert closed.value.rcvd is not None
    assert (closed.value.rcvd.code, closed.value.rcvd.reason) == expected
    assert (code, out) == (0, "")
    assert "Traceback" not in err
    assert re.search(r"/client_1_[0-9a-f]{6} has connected from 127\.0\.0\.1:", err)


def test_second_signal_ends_a_long_drain() -> None:
    with ExitStack() as stack:
        hub = stack.enter_context(running_as(NOT_REPEATED, "--port", "0", "--drain", "600"))
        url = hub.url()
        clients = [stack.enter_context(connect(url)) for _ in range(40)]
        hub.process.terminate()
        codes = [_close_code(clients[0])]  # It is closed with the first ones.
        hub.process.terminate()
        codes += [_close_code(client) for client in clients[1:]]
        code, _, _ = hub.end()
    assert code == 0
    assert codes[0] == 1012 and codes[-1] == 1001, codes


def _close_code(client: ClientConnection) -> int:
    with pytest.raises(ConnectionClosed) as closed:
        client.recv(PATIENCE)
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code


def test_log_in_json_is_all_that_the_hub_writes() -> None:
    with running("--port", "0", "--log-format", "json") as hub:
        assert hub.process.stderr is not None
        listening = json.loads(hub.process.stderr.readline())
        assert listening["event"] == "listening"
        with connect(f"{listening['url']}/?node=/talker"):
            connected = json.loads(hub.process.stderr.readline())
        assert connected["event"] == "connected"
        assert (connected["node"], connected["ip"]) == ("/talker", "127.0.0.1")
        left = json.loads(hub.process.stderr.readline())
        assert (left["event"], left["node"]) == ("left", "/talker")
        hub.process.terminate()
        code, out, err = hub.end()
    assert (code, out, err) == (0, "", "")


def test_reason_for_not_starting_is_json_if_the_log_is() -> None:
    with running("--host", "192.0.2.1", "--log-format", "json") as hub:
        code, out, err = hub.end()
    assert (code, out) == (1, "")
    assert "192.0.2.1" in json.loads(err)["message"]


def test_signal_right_after_the_first_line_is_not_lost(tmp_path: Path) -> None:
    """A script that waits for the line may stop the hub at once."""
    file = tmp_path / "hub.url"
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    filled = 0
    try:
        while True:
            filled += os.write(writing, bytes(4096))
    except BlockingIOError:
        pass
    os.set_blocking(writing, True)
    process = fork_server.popen(
        ["-m", "fibws.hub", "--port", "0", "--url-file", str(file)],
        stdout=writing,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        os.close(writing)
        try:
            _read_url(file)
            process.send_signal(signal.SIGTERM)
            with open(reading, "rb") as pipe:
                pipe.read(filled)
                pipe.read()
            _, err = process.communicate(timeout=PATIENCE)
        finally:
            if process.poll() is None:
                process.kill()
    assert (process.returncode, err) == (0, "")


@pytest.mark.parametrize("which", [[1], [2], [1, 2]], ids=["stdout", "stderr", "both"])
@pytest.mark.parametrize("how", ["full disk", "closed pipe", "closed"])
@pytest.mark.long
def test_hub_survives_a_closed_output(how: str, which: list[int], tmp_path: Path) -> None:
    file = tmp_path / "hub.url"
    reading, pipe = os.pipe()
    os.close(reading)
    output = {"full disk": os.open("/dev/full", os.O_WRONLY), "closed pipe": pipe}.get(how)
    closed = " ".join(f"{number}>&-" for number in which) if output is None else ""
    hub = shlex.join([sys.executable, "-m", "fibws.hub", "--port", "0", "--url-file", str(file)])
    process = subprocess.Popen(
        f"exec {hub} {closed}",
        shell=True,
        stdout=output if 1 in which else subprocess.PIPE,
        stderr=output if 2 in which else subprocess.PIPE,
        text=True,
    )
    with process:
        try:
            url = _read_url(file)
            for _ in range(2):  # The second one gets file descriptors that the first one had.
                with connect(url) as websocket:
                    websocket.send("{}")
                    assert json.loads(websocket.recv(PATIENCE))["op"] == "status"
            process.send_signal(signal.SIGTERM)
            _, err = process.communicate(timeout=PATIENCE)
        finally:
            if process.poll() is None:
                process.kill()
            for number in {pipe} if output is None else {pipe, output}:
                os.close(number)
    assert process.returncode == 0
    if which == [1]:
        assert "Traceback" not in err
        assert err.count("Cannot write to stdout: ") == (how != "closed")


@pytest.mark.long
def test_open_file_limit_is_raised_to_the_connection_limit() -> None:
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    hard = limits[1]
    resource.setrlimit(resource.RLIMIT_NOFILE, (200, hard))  # The hub's first, too.
    try:
        for most, expected in [(100, 356), (hard, hard)]:
            with running("--port", "0", "--max-connections", str(most)) as hub:
                hub.url()
                soft, _ = resource.prlimit(hub.process.pid, resource.RLIMIT_NOFILE)
            assert soft == expected
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


@pytest.mark.parametrize("loop", ["asyncio", "uvloop"])
@pytest.mark.long
def test_limit_of_open_files_is_logged_once_a_second(tmp_path: Path, loop: str) -> None:
    paths = [os.getcwd()]
    if loop == "asyncio":
        (tmp_path / "uvloop.py").write_text("raise ImportError")
        paths.insert(0, str(tmp_path))
    with running("--port", "0", PYTHONPATH=os.pathsep.join(paths)) as hub:
        port = int(hub.url().rpartition(":")[2])
        resource.prlimit(hub.process.pid, resource.RLIMIT_NOFILE, (64, 64))
        began = time.monotonic()
        with ExitStack() as stack:
            for _ in range(100):
                stack.enter_context(socket.create_connection(("127.0.0.1", port)))
            assert hub.process.stderr is not None
            line = hub.process.stderr.readline()
        with _connect_again(port) as websocket:
            websocket.send("{}")
            assert json.loads(websocket.recv(PATIENCE))["op"] == "status"
        hub.process.terminate()
        _, _, err = hub.end()
        seconds = time.monotonic() - began
    complaint = "Cannot accept more connections: the limit of 64 open files is reached (ulimit -n)."
    assert complaint in line
    assert err.count("Cannot accept more connections") <= seconds
    assert "Traceback" not in err


def test_url_file_holds_the_url_while_the_hub_runs(tmp_path: Path) -> None:
    file = tmp_path / "hub.url"
    file.write_text("ws://127.0.0.1:1")  # as a hub that was killed leaves it
    with running("--port", "0", "--url-file", str(file)) as hub:
        url = hub.url()
        assert file.read_text() == f"{url}\n"
        with connect(url):
            hub.process.terminate()
            assert hub.end()[0] == 0
    assert list(tmp_path.iterdir()) == []


def test_url_file_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "missing" / "hub.url"
    with running("--port", "0", "--url-file", str(file)) as hub:
        code, out, err = hub.end()
    assert (code, out) == (1, "")
    assert str(file) in err and "Traceback" not in err


def test_failed_hub_leaves_no_url_file(tmp_path: Path) -> None:
    file = tmp_path / "hub.url"
    file.write_text("ws://127.0.0.1:1")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        with running("--port", port, "--url-file", str(file)) as hub:
            assert hub.end()[0] == 1
    assert not file.exists()


def test_port_in_use_is_one_line_and_exit_code_1() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with running("--port", str(port)) as hub:
            code, out, err = hub.end()
    assert (code, out) == (1, "")
    assert re.fullmatch(
        rf"fibws\.hub: Port {port} on 127\.0\.0\.1 is in use by another program.*--port.*\n", err
    )


@pytest.mark.parametrize(
    ("option", "value"),
    [("--record", "/etc/passwd"), ("--join", "http://robot"), ("--url-file", "/etc/passwd/url")],
)
def test_option_that_cannot_be_fulfilled_is_one_line_and_exit_code_1(
    option: str, value: str
) -> None:
    with running("--port", "0", option, value) as hub:
        code, out, err = hub.end()
    assert (code, out) == (1, "")
    assert err.startswith(f"fibws.hub: {option}: ")
    assert len(err.splitlines()) == 1


def test_hub_runs_without_uvloop(tmp_path: Path) -> None:
    (tmp_path / "uvloop.py").write_text("raise ImportError")
    with running("--port", "0", PYTHONPATH=os.pathsep.join([str(tmp_path), os.getcwd()])) as hub:
        with connect(hub.url()) as websocket:
            websocket.send("{}")
            assert json.loads(websocket.recv(PATIENCE))["op"] == "status"
        hub.process.terminate()
        assert hub.end()[0] == 0


@pytest.mark.parametrize(
    ("flag", "variable", "host"),
    [(True, True, "127.0.0.4"), (False, True, "127.0.0.3"), (False, False, "127.0.0.2")],
    ids=["a flag", "the environment", "the file"],
)
def test_flags_override_environment_and_environment_overrides_the_file(
    tmp_path: Path, flag: bool, variable: bool, host: str
) -> None:
    config = tmp_path / "hub.toml"
    config.write_text('host = "127.0.0.2"\nport = 0\n')
    arguments = ["--config", str(config)] + ["--host", "127.0.0.4"] * flag
    environment = {"FIBWS_HOST": "127.0.0.3"} if variable else {}
    with running(*arguments, **environment) as hub:
        assert f"ws://{host}:" in hub.first_line()


@pytest.mark.parametrize("origins", ['["https://lab.example"]', '"https://lab.example"'])
def test_config_file_may_be_set_by_the_environment(tmp_path: Path, origins: str) -> None:
    config = tmp_path / "hub.toml"
    config.write_text(f'host = "127.0.0.2"\nport = 0\nallow_origin = {origins}\n')
    with (
        running(FIBWS_CONFIG=str(config)) as hub,
        connect(
            hub.url(),
            origin=Origin("https://lab.example"),
        ) as websocket,
    ):
        websocket.send("{}")
        assert json.loads(websocket.recv(PATIENCE))["op"] == "status"


@pytest.mark.parametrize("flag", ["-h", "--help"])
def test_help_lists_every_setting_with_its_default(flag: str) -> None:
    result = CliRunner().invoke(command, [flag])
    assert result.exit_code == 0, result.output
    for field in dataclasses.fields(Settings):
        assert f"--{flag_of(field)}" in result.output
    assert "9090" in result.output


def test_only_the_program_changes_the_garbage_collector() -> None:
    code = (
        "import atexit, gc\n"
        "show = lambda: print(gc.get_threshold()[0], gc.get_freeze_count() > 0)\n"
        "show(); import fibws.hub.__main__ as main\n"
        "show(); atexit.register(show); main.main()"
    )
    argv = [sys.executable, "-c", code, "--host", "256.0.0.1"]
    process = subprocess.run(argv, capture_output=True, text=True, timeout=PATIENCE, check=False)
    before, imported, running = process.stdout.splitlines()
    assert before == imported and before.endswith(" False")
    assert running == "10000 True" != before


def test_version_is_the_packages() -> None:
    assert CliRunner().invoke(command, ["--version"]).output == f"fibws {__version__}\n"


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("prot = 1", "setting prot; did you mean port?"),
        ('allow_orign = ["*"]', "setting allow_orign; did you mean allow_origin?"),
        ("port = ", "Invalid value"),
        ('port = "x"', "'port in {config}': 'x' is not a valid integer"),
        ("port = 70000", "port in {config} must be between 0 and 65535, got 70000"),
        ('cert = "hub.pem"', "cert in {config} requires key in {config}"),
        ('ping_interval = "often"', "not a valid float"),
        ('fast_framing = "perhaps"', "not a valid boolean"),
        ("allow_origin = 5", "Invalid value"),
        ("[hub]\nport = 1", "in no section, not in [hub]"),
        ("host = 0.0.0.0", "in quotes, as in host ="),
    ],
)
def test_invalid_config_file_is_refused_with_the_reason(
    tmp_path: Path, text: str, complaint: str
) -> None:
    config = tmp_path / "hub.toml"
    config.write_text(text)
    result = CliRunner().invoke(command, ["--config", str(config)])
    assert (result.exit_code, result.exception.__class__) in ((2, SystemExit), (1, SystemExit))
    said = " ".join([result.output, str(result.exception)]).replace("\n", " ")
    assert complaint.format(config=config) in said
    assert complaint.startswith("Invalid") or "--" not in said.replace("--help", "").replace(
        "'--config'", ""
    )


@pytest.mark.parametrize(
    ("arguments", "variable", "name"),
    [
        (["--port", "70000"], None, "--port"),
        ([], "70000", "FIBWS_PORT"),
        (["--port", "70000"], "9090", "--port"),
        (["--port", "x"], None, "--port"),
        ([], "x", "FIBWS_PORT"),
    ],
)
def test_error_names_what_the_setting_was_set_by(
    arguments: list[str], variable: str | None, name: str
) -> None:
    result = CliRunner().invoke(command, arguments, env={"FIBWS_PORT": variable})
    said = f"{result.output} {result.exception}"
    assert name in said
    assert [each for each in ("--port", "FIBWS_PORT") if each in said] == [name]


def test_config_file_may_begin_with_a_byte_order_mark(tmp_path: Path) -> None:
    config = tmp_path / "hub.toml"
    config.write_text("prot = 1", "utf-8-sig")
    result = CliRunner().invoke(command, ["--config", str(config)])
    assert "unknown setting prot" in result.output


def test_missing_or_binary_config_file_is_refused(tmp_path: Path) -> None:
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe")
    for path in (tmp_path / "none.toml", binary):
        result = CliRunner().invoke(command, ["--config", str(path)])
        assert result.exit_code == 2
        assert str(path) in result.output and "Errno" not in result.output


def test_setting_without_effect_is_called_by_what_set_it(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    config = tmp_path / "hub.toml"
    config.write_text('as = "/robot7"')
    context = command.make_context("hub", ["--config", str(config), "--ros1-allow", "10.0.0.1"])
    settings = Settings(join_prefix="/robot7", ros1_allow=("10.0.0.1",))
    _warn_of_mistakes(context, settings)
    assert f"as in {config} has no effect without join in {config}" in caplog.text
    assert "--ros1-allow has no effect without " in caplog.text


def test_misspelled_variable_is_named(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    names = ("FIBWS_PROT", "FIBWS_TOKEN", "FIBWS_TOKEN_FILE", "FIBWS_CA", "FIBWS_OTHER_THING")
    for name in names:
        monkeypatch.setenv(name, "1")
    _warn_of_mistakes(command.make_context("hub", []), Settings())
    [record] = caplog.records
    assert record.getMessage() == "FIBWS_PROT is not a setting; did you mean FIBWS_PORT?"


@pytest.mark.parametrize(
    "arguments",
    [
        ["--port", "65536"],
        ["--port", "99999"],
        ["--port", "-1"],
        ["--port", "x"],
        ["--nope"],
        ["--queue-length", "-1"],
        ["--max-queued-bytes", "-1"],
        ["--max-connections", "-1"],
        ["--max-total-queued-bytes", "-1"],
        ["--max-total-incoming-bytes", "-1"],
        ["--max-message-size", "-1"],
        ["--stall-timeout", "-1"],
        ["--ping-interval", "nan"],
        ["--ping-timeout", "-1"],
        ["--close-timeout", "-1"],
        ["--open-timeout", "nan"],
    ],
    ids=" ".join,
)
def test_invalid_setting_is_refused(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def serve(*_: object) -> None:
        raise AssertionError("it would have started")

    monkeypatch.setattr("fibws.hub.__main__._serve", serve)
    result = CliRunner().invoke(command, arguments)
    assert result.exit_code in (1, 2)
    assert isinstance(result.exception, SystemExit), result.exception
    assert arguments[0] in result.output


def test_missing_interfaces_folder_is_one_line() -> None:
    with running("--port", "0", "--interfaces", "/no/such/folder") as hub:
        code, out, err = hub.end()
    assert (code, out) == (1, "")
    assert err == "fibws.hub: --interfaces: /no/such/folder: folder of definitions not found.\n"


def _read_url(file: Path) -> str:
    """Wait until a hub has written its URL: one whose output is blocked cannot print it."""
    until = time.monotonic() + PATIENCE
    while not file.exists():
        assert time.monotonic() < until
        time.sleep(0.01)
    return file.read_text().strip()


def _connect_again(port: int) -> ClientConnection:
    """Open a WebSocket as soon as the hub has room for it."""
    until = time.monotonic() + PATIENCE
    while True:
        try:
            return connect(f"ws://127.0.0.1:{port}", open_timeout=PATIENCE)
        except (OSError, WebSocketException):
            assert time.monotonic() < until
            time.sleep(0.05)
