"""``python -m fibws.hub``: the hub as a program."""

from __future__ import annotations

import asyncio
import dataclasses
import gc
import logging
import os
import signal
import sys
import tomllib
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

import click
from click.core import ParameterSource

from fibws import __version__
from fibws.errors import FibwsError, HubError, SettingError
from fibws.exit_signals import ExitSignals, end_at_once
from fibws.files import replace_file
from fibws.hub.announcement import announcement
from fibws.hub.log import output as log_output
from fibws.hub.monitoring.service_manager import ServiceManager
from fibws.hub.server import HubServer
from fibws.hub.settings import MIB, Settings, flag_of
from fibws.suggestions import misspelled, suggestion

logger = logging.getLogger("fibws.hub")

OWN_FILES = 256
"""Files that the hub may open besides its clients' connections."""

OTHER_VARIABLES = {"ros1_host": ("ROS_HOSTNAME", "ROS_IP")}
"""Environment variables of ROS that count as settings."""

NO_SETTINGS = (
    *("FIBWS_CA", "FIBWS_CLIENT_CERT", "FIBWS_CLIENT_KEY", "FIBWS_CONFIG", "FIBWS_HUB"),
    *("FIBWS_PYTHON", "FIBWS_SETUP", "FIBWS_SITE", "FIBWS_TOKEN", "FIBWS_TOKEN_FILE"),
)
"""Other variables of fibws."""

_CONFIG = "fibws.config"
"""Where a context keeps the path of the file of settings."""

_PATH: click.Path = click.Path(path_type=Path)


def main() -> None:
    """Run the hub until Ctrl-C or SIGTERM."""
    command(prog_name="python -m fibws.hub")


def _read_config(context: click.Context, _: click.Parameter, path: Path | None) -> None:
    if path is None:
        return
    try:
        values = tomllib.loads(path.read_text("utf-8-sig"))
    except UnicodeDecodeError:
        raise click.BadParameter(f"{path} is not UTF-8") from None
    except OSError as error:
        raise click.BadParameter(f"cannot read {path}: {error.strerror}") from None
    except ValueError as error:
        example = 'write texts in quotes, as in host = "0.0.0.0"'
        raise click.BadParameter(f"{path}: {error}; {example}") from None
    known = {_key(flag_of(field)): field for field in dataclasses.fields(Settings)}
    context.default_map = {}
    context.meta[_CONFIG] = path
    for name, value in values.items():
        if name not in known:
            if isinstance(value, dict):
                raise click.BadParameter(f"{path}: settings are in no section, not in [{name}]")
            meant = suggestion(name, known)
            raise click.BadParameter(f"{path}: unknown setting {name}{meant}")
        is_one = known[name].default == () and isinstance(value, str)
        context.default_map[known[name].name] = [value] if is_one else value


def _options(function: Callable[..., None]) -> Callable[..., None]:
    """Add one option for each of the settings."""
    types = get_type_hints(Settings)
    for field in reversed(dataclasses.fields(Settings)):
        type_ = types[field.name]
        if get_origin(type_) is Literal:
            type_ = click.Choice(get_args(type_))
        many = get_origin(type_) is tuple
        if type_ == int | None:
            type_ = int
        flag = flag_of(field)
        function = click.option(
            f"--{flag}/--no-{flag}" if type_ is bool else f"--{flag}",
            field.name,
            type=_PATH if Path in get_args(type_) else get_args(type_)[0] if many else type_,
            multiple=many,
            default=field.default,
            show_default=not many,
            envvar=[_variable(flag), *OTHER_VARIABLES.get(field.name, ())],
            help=field.metadata["help"],
            cls=_Option,
        )(function)
    return function


def _key(flag: str) -> str:
    return flag.replace("-", "_")


class _Option(click.Option):
    """An option that errors call by what it was set by: a flag, a variable, or a file's key."""

    def get_error_hint(self, ctx: click.Context | None) -> str:
        """Return that name."""
        return super().get_error_hint(ctx) if ctx is None else f"'{source_of(ctx, self)}'"


def source_of(context: click.Context, option: click.Parameter) -> str:
    """Return what an option was set by, or could be set by: ``--port``, or ``port in hub.toml``."""
    source, path = context.get_parameter_source(option.name or ""), context.meta.get(_CONFIG)
    flag = option.opts[0]
    if source is ParameterSource.ENVIRONMENT:
        variables = [option.envvar] if isinstance(option.envvar, str) else option.envvar or []
        return next((each for each in variables if os.environ.get(each)), flag)
    if path is not None and source in (ParameterSource.DEFAULT_MAP, ParameterSource.DEFAULT):
        return f"{_key(flag.removeprefix('--'))} in {path}"
    return flag


def explained(context: click.Context, error: FibwsError) -> str:
    """Return an error's text, with the names by which the settings in it were set."""
    if not isinstance(error, SettingError):
        return str(error)
    options = {each.opts[0]: each for each in command.params}
    return error.named(lambda flag: source_of(context, options[flag]) if flag in options else flag)


def _variable(flag: str) -> str:
    return f"FIBWS_{flag.replace('-', '_').upper()}"


@click.command(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, message="fibws %(version)s")
@click.option(
    "--config",
    type=click.Path(path_type=Path, dir_okay=False),
    is_eager=True,
    expose_value=False,
    callback=_read_config,
    envvar="FIBWS_CONFIG",
    cls=_Option,
    help="TOML file of settings, named like the flags, with _ for -.",
)
@_options
@click.option(
    "--url-file",
    metavar="FILE",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write the hub's URL and a newline to FILE as soon as nodes can connect; FILE is removed "
    "when the hub ends.",
)
def command(url_file: Path | None, **values: Any) -> None:
    """Run a hub for ROS nodes and web pages: rosbridge v2.0 over WebSockets, without ROS.

    A flag takes precedence over an environment variable (FIBWS_PORT for --port), and that over the
    file.

    \b
    In a script, on a free port:
      fibws hub --port 0 --url-file hub.url &
      until [ -s hub.url ]; do sleep 0.1; done
      export FIBWS_HUB=$(cat hub.url)
    """
    context = click.get_current_context()
    _open_standard_files()
    log_output.configure(values["log_format"])
    # Makes glibc keep freed memory: otherwise it trims and grows its heap with every large message,
    # which costs more than relaying it.
    bytearray(16 * MIB)
    _relax_collector()
    try:
        settings = Settings(**values)
        _warn_of_mistakes(context, settings)
        _raise_file_limit(settings.max_connections + OWN_FILES)
        with asyncio.Runner(loop_factory=_loop_factory()) as runner:
            runner.run(_serve(settings, url_file))
    except FibwsError as error:
        if values["log_format"] == "json":
            logger.critical("%s.", explained(context, error), extra={"event": "failed"})
            sys.exit(1)
        sys.exit(f"fibws.hub: {explained(context, error)}.")
    except KeyboardInterrupt:
        pass
    finally:
        _flush_output()


def environment_settings(flags: Sequence[str] = ()) -> Settings:
    """Return the settings of flags, environment variables and $FIBWS_CONFIG, in that order.

    Raises:
        ClickException: a flag or a variable is unknown or invalid, or out of its range.
    """
    context = command.make_context("fibws hub", list(flags))
    names = [field.name for field in dataclasses.fields(Settings)]
    try:
        return Settings(**{name: context.params[name] for name in names})
    except HubError as error:
        raise click.UsageError(f"{explained(context, error)}.", context) from None


def _warn_of_mistakes(context: click.Context, settings: Settings) -> None:
    """Log settings that have no effect, and variables that are probably misspelled settings."""
    for error in settings.without_effect():
        logger.warning("%s.", explained(context, error))
    known = [_variable(flag_of(field)) for field in dataclasses.fields(Settings)]
    for name in os.environ:
        if name.startswith("FIBWS_") and name not in (*known, *NO_SETTINGS):
            if meant := misspelled(name, known):
                logger.warning("%s is not a setting; did you mean %s?", name, meant)


async def _serve(settings: Settings, url_file: Path | None) -> None:
    loop = asyncio.get_running_loop()
    signals: asyncio.Queue[int] = asyncio.Queue()

    def stop(number: int) -> None:
        if sys.stderr is not None and sys.stderr.isatty():
            click.echo(err=True)  # The log must not continue the line of the terminal's ^C.
        signals.put_nowait(number)

    def stop_at_once(number: int) -> None:
        if is_draining:
            signals.put_nowait(number)
        else:
            end_at_once(number)

    is_draining = False
    exit_signals = ExitSignals(stop, stop_at_once)
    exit_signals.install(loop, (signal.SIGINT, signal.SIGTERM))
    _remove(url_file)  # An earlier hub may have been killed.
    async with HubServer(settings) as hub:
        manager = ServiceManager(loop, hub._status)
        hub.stop_requested = lambda reason: _stop_for(reason, stop)
        _reload_on_hangup(hub, manager, stop)
        _write(url_file, hub.url)
        _announce(settings, hub.url, hub.ros1.uri if hub.ros1 is not None else "")
        manager.ready()
        try:
            first = await signals.get()
            manager.stopping()
            if first == signal.SIGTERM:
                is_draining = True
                await _drain(hub, signals)
                is_draining = False
        finally:
            manager.close()
            _remove(url_file)


def _reload_on_hangup(hub: HubServer, manager: ServiceManager, stop: Callable[[int], None]) -> None:
    """Reload the hub's files on SIGHUP; stop it if that came because its terminal was closed."""
    if sys.platform == "win32":
        return  # It has neither the signal nor /dev/tty.
    has_terminal = _has_terminal()

    def on_hangup() -> None:
        if has_terminal and not _has_terminal():
            stop(signal.SIGHUP)
        else:
            _reload(hub, manager)

    asyncio.get_running_loop().add_signal_handler(signal.SIGHUP, on_hangup)


async def _drain(hub: HubServer, signals: asyncio.Queue[int]) -> None:
    """Let the clients go one after the other, unless another signal comes."""
    draining = asyncio.ensure_future(hub.drain(hub.settings.drain))
    again = asyncio.ensure_future(signals.get())
    await asyncio.wait({draining, again}, return_when=asyncio.FIRST_COMPLETED)
    for task in (draining, again):
        task.cancel()
    await asyncio.wait({draining, again})
    if not draining.cancelled():
        draining.result()


def _reload(hub: HubServer, manager: ServiceManager) -> None:
    what = "certificates, tokens and keys"

    def done(changes: list[str]) -> None:
        hub.audit.reloaded(what, changes, hub._files)
        manager.ready()

    manager.reloading()
    try:
        hub.reload(done)
    except FibwsError as error:
        text = explained(click.get_current_context(), error)
        hub.audit.reload_failed(what, text)
        manager.ready()


def _has_terminal() -> bool:
    """Return whether the process has a terminal that can end it by closing."""
    if sys.platform == "win32":
        return False
    try:
        os.close(os.open("/dev/tty", os.O_RDONLY | os.O_NOCTTY))
    except OSError:
        return False
    return True


def _stop_for(reason: str, stop: Callable[[int], None]) -> None:
    """Stop the hub for a ROS 1 program."""
    logger.info("Shutting down for %s.", reason)
    stop(signal.SIGTERM)


def _announce(settings: Settings, url: str, master_uri: str) -> None:
    """Print where the hub is, or log it where the output must be JSON."""
    text = announcement(settings, url, master_uri)
    if settings.log_format == "json":
        fields = {"url": url} | ({"ros_master_uri": master_uri} if master_uri else {})
        logger.info("%s", text, extra={"event": "listening", "fields": fields})
        return
    try:
        print(text, flush=True)
    except OSError as error:
        logger.warning("Cannot write to stdout: %s.", error.strerror)


def _write(url_file: Path | None, url: str) -> None:
    if url_file is None:
        return
    try:
        replace_file(url_file, f"{url}\n".encode())
    except OSError as error:
        raise HubError(f"--url-file: cannot write {url_file}: {error.strerror}") from None


def _remove(url_file: Path | None) -> None:
    if url_file is not None:
        with suppress(OSError):
            url_file.unlink(missing_ok=True)


def _relax_collector() -> None:
    """Make cyclic garbage collections rarer, and skip permanent objects.

    Decoding a long list allocates a million objects at once, none of them garbage: with Python's
    default of a collection per 700, these take two to four fifths of the time.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000)


def _open_standard_files() -> None:
    """Open those of stdin, stdout and stderr that the program was started without.

    Otherwise their numbers are those of the first sockets, which uvloop aborts on.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # The lowest number that is free.


def _flush_output() -> None:
    """Flush stdout and stderr, or discard their buffers.

    A full disk or a closed pipe must not change the exit code.
    """
    for stream in (sys.stdout, sys.stderr):
        try:
            if stream is not None:
                stream.flush()
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)


def _raise_file_limit(count: int) -> None:
    """Allow the process that many open files, or as many as the system lets it have."""
    if sys.platform == "win32":
        return  # It has no such limit.
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY or soft >= count:
        return
    if hard != resource.RLIM_INFINITY:
        count = min(count, hard)
    with suppress(OSError, ValueError):  # macOS allows fewer than it says.
        resource.setrlimit(resource.RLIMIT_NOFILE, (count, hard))


def _loop_factory() -> Callable[[], asyncio.AbstractEventLoop] | None:
    """Return uvloop's if it is installed, which saves about 10 % of the hub's CPU time."""
    try:
        import uvloop
    except ImportError:
        return None
    return uvloop.new_event_loop


if __name__ == "__main__":
    main()
