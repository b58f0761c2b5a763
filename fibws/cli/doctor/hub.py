"""Checks of the hub: address, version, round trip, clock."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import Any
from urllib.parse import urlsplit

from fibws import __version__, hub_address, tls
from fibws.access.token_file import ANONYMOUS
from fibws.cli.doctor.finding import Finding, ok, warning, wrong
from fibws.client import hub_pages
from fibws.client.hub_client import HubClient
from fibws.command_names import command_name
from fibws.errors import (
    AccessDenied,
    AccessError,
    HubLost,
    HubUnreachable,
    InvalidAddress,
    InvalidName,
    NoHub,
    NotAuthorized,
    ServiceError,
)

TOKENS = "How to create tokens: fibws token --help"
UNKNOWN = {"0.0", "0.1.0.dev0"}
"""The versions of builds that had no git, and of checkouts that were never installed."""
ROUND_TRIPS = 5
SLOW_ROUND_TRIP = 0.1
"""Seconds of a round trip that a person notices."""
CERTIFICATE_RESERVE = 3 * 24 * 3600
"""Seconds before the end of a certificate from which it should have been renewed."""
MAX_CLOCK_DIFFERENCE = 0.5
"""Seconds by which clocks may differ without confusing programs that compare stamps."""


def url_of(hub: str | None) -> str:
    """Return the hub's address as the user wrote it."""
    return hub or os.environ.get(hub_address.ENVIRONMENT) or hub_address.DEFAULT


def reach(hub: str | None) -> HubClient | Finding:
    """Connect to the hub; return a finding if that fails."""
    scheme = "wss" if url_of(hub).startswith("wss:") else "ws"
    other = f"set its address: {hub_address.ENVIRONMENT}={scheme}://HOST:PORT"
    try:
        return _accepted(HubClient("doctor", hub))
    except (InvalidAddress, InvalidName, AccessError):
        return wrong("hub", "Not checked", "Fix the environment first, see above.")
    except AccessDenied as error:
        return wrong(
            "hub", f"The hub at {error.url} refuses this client: {error.cause}", _advice(error)
        )
    except HubLost as error:
        return wrong("hub", str(error), "Check the hub's log. Is it a hub of fibws?")
    except NoHub as error:
        text = f"No hub at {error.url} ({_source(hub)}; {error.cause})"
        return wrong("hub", text, f"{error.remedy}. Or {other}")
    except HubUnreachable as error:
        what, _, remedy = error.cause.partition("; ")
        if remedy:
            text = f"The hub at {error.url} cannot be reached: {what}"
            return wrong("hub", text, f"{remedy[0].upper()}{remedy[1:]}.")
        if (variable := error.cause.partition(":")[0]) in tls.VARIABLES:
            return wrong("hub", f"{error}", f"Correct {variable}, or: unset {variable}")
        if (server := http_server(error.url)) is None:
            return wrong("hub", f"{error}", f"Check the address and the network, or {other}")
        return wrong("hub", f"{error}. {server}", f"Check which program listens there, or {other}")


def _accepted(client: HubClient) -> HubClient:
    """Return a client once the hub answers it: a refusal may come after the connection is open."""
    try:
        client.call("/rosapi/get_time")
    except ServiceError:
        pass  # `round_trip` reports it.
    except BaseException:
        client.close()
        raise
    return client


def _advice(error: AccessDenied) -> str:
    return f"{error.remedy}. {TOKENS}" if isinstance(error, NotAuthorized) else f"{error.remedy}."


def token(client: HubClient) -> Iterator[Finding]:
    """Say whether the hub wants a token, and whether it has accepted this client's.

    Nothing is said about a hub that does not answer this question.
    """
    try:
        _, _, body = hub_pages.get(client.url, "login")
        login = json.loads(body)
        wants, name = login["required"], login.get("name")
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return
    given = client.credentials
    if wants and given:
        yield ok("token", f"The hub accepts the token in {given.source}")
    elif wants and name not in (None, ANONYMOUS):
        yield ok("token", f"The hub accepts the certificate in {tls.CLIENT_CERT}, as {name}")
    elif wants:
        yield ok("token", "The hub lets in this client without a token, as anonymous")
    elif given:
        text = f"The hub does not check the token in {given.source}: everybody may enter"
        yield warning("token", text, f"Start the hub with --tokens FILE. {TOKENS}")
    else:
        yield ok("token", "The hub wants no token: everybody who reaches it may enter")


def _source(hub: str | None) -> str:
    if hub:
        return "from --hub"
    is_set = os.environ.get(hub_address.ENVIRONMENT)
    return f"{'from ' if is_set else ''}{hub_address.ENVIRONMENT}{'' if is_set else ' is not set'}"


def http_server(url: str) -> str | None:
    """Describe the HTTP server at an address; None if there is none."""
    try:
        status, headers, _ = hub_pages.get(url, "")
    except (OSError, ValueError, HubUnreachable):
        return None
    server = headers.get("server", "")
    return f"It answers HTTP requests with {status}{f' (server: {server})' if server else ''}"


def certificate(end: float | None, now: float) -> Iterator[Finding]:
    """Say until when the server's certificate is valid.

    Args:
        end: in seconds since 1970; None if the hub has no TLS.
        now: the time.
    """
    if end is None:
        return
    text = f"The certificate is valid until {datetime.fromtimestamp(end, UTC):%Y-%m-%d %H:%M} UTC"
    if end - now > CERTIFICATE_RESERVE:
        yield ok("certificate", text)
    else:
        advice = "Renew it; the hub reads it again on SIGHUP, a proxy when it is reloaded."
        yield warning("certificate", text, advice)


def warnings(url: str, headers: Mapping[str, str]) -> Iterator[Finding]:
    """Yield what the hub warns of, such as a recording that has failed.

    It is shown only to tokens with the right admin.
    """
    try:
        found: Any = json.loads(hub_pages.get(url, "healthz", headers)[2])["warnings"]
    except (OSError, ValueError, KeyError, TypeError):
        return
    for each in found:
        yield warning("health", f"The hub warns: {each}", "See the hub's log.")


def version(url: str, headers: Mapping[str, str] | None = None) -> Finding:
    """Compare the hub's version with this one.

    Args:
        url: the hub's URL.
        headers: those of the token.
    """
    try:
        status, _, body = hub_pages.get(url, "healthz", headers)
    except (OSError, ValueError) as error:
        return warning(
            "version",
            f"{url} does not answer an HTTP request: {error}",
            "If there is a proxy, let it forward /healthz.",
        )
    try:
        health: Any = json.loads(body)
        if health == {"status": "ok"}:
            return ok("version", "The hub shows its version only to tokens with the right admin")
        theirs = str(health["version"])
    except (ValueError, KeyError, TypeError):
        return warning(
            "version",
            f"/healthz answers {status} without a version: {_first_line(body)}",
            _advice_without_version(url, status),
        )
    text = f"The hub is fibws {theirs}, this is {__version__}"
    if not UNKNOWN.isdisjoint((theirs, __version__)):
        return ok("version", f"{text}; one was built without git and does not know its version")
    if theirs.split(".")[:2] == __version__.split(".")[:2]:
        return ok("version", text)
    return warning(
        "version",
        text,
        "Install the same version on both: python -m pip install --upgrade fibws",
    )


def _advice_without_version(url: str, status: int) -> str:
    path = urlsplit(url).path.rstrip("/")
    if path and status == 404:
        return f"If a proxy passes on {path}, start the hub with --url-path {path}."
    return "If it is another rosbridge server, some tools will not work with it."


def master(client: HubClient) -> tuple[str, int | None]:
    """Return the hub's run_id, and the port of its ROS 1 master.

    The port is None if the hub has no master, or shows it only to admins.

    Raises:
        NodeError: the hub does not respond.
    """
    run_id = json.loads(
        client.call("/rosapi/get_param", {"name": "/run_id", "default": '""'})["value"]
    )
    return str(run_id), hub_pages.ros1_port(client.url)


def round_trip(client: HubClient) -> Iterator[Finding]:
    """Measure the time of a call, and the difference between the clocks.

    Raises:
        NodeError: the hub does not respond.
    """
    trips = []
    for _ in range(ROUND_TRIPS):
        start, wall = time.perf_counter(), time.time()
        stamp = client.call("/rosapi/get_time")["time"]
        seconds = time.perf_counter() - start
        theirs = stamp["secs"] + stamp["nsecs"] / 1e9
        trips.append((seconds, theirs - (wall + seconds / 2)))
    seconds, ahead = min(trips)  # The shortest trip has the smallest error.
    text = f"A call takes {seconds * 1000:.1f} ms"
    if seconds <= SLOW_ROUND_TRIP:
        yield ok("round trip", text)
    else:
        advice = f"Is the network slow, or the hub busy? See: {command_name('top')}"
        yield warning("round trip", text, advice)
    yield clock(ahead, seconds / 2)


def clock(ahead: float, error: float) -> Finding:
    """Judge the seconds by which the hub's clock is ahead, with the error of that measurement."""
    if abs(ahead) <= error:
        return ok("clock", f"The clocks agree within {error * 1000:.1f} ms")
    side = "ahead of" if ahead > 0 else "behind"
    text = f"The hub's clock is {abs(ahead):.3f} s {side} this machine's"
    if abs(ahead) - error <= MAX_CLOCK_DIFFERENCE:
        return ok("clock", text)
    return warning(
        "clock", text, "Synchronize both clocks with NTP; otherwise stamps cannot be compared."
    )


def _first_line(body: bytes) -> str:
    return body.decode(errors="replace").strip().partition("\n")[0][:80]
