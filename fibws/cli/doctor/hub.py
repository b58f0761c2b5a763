"""Whether there is a hub, which one, how far away, and what its clock says."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Iterator
from typing import Any
from urllib.parse import urlsplit

from fibws import __version__, hub_address
from fibws.cli.doctor.finding import Finding, ok, warning, wrong
from fibws.client.hub_client import HubClient
from fibws.errors import HubUnreachable, InvalidAddress, InvalidName, NoHub

PATIENCE = 3.0
"""Seconds in which a plain HTTP request must be answered."""
TRIPS = 5
SLOW_TRIP = 0.1
"""Seconds there and back that one begins to notice."""
CLOCKS = 0.5
"""Seconds by which clocks may differ before stamps of messages look old, or of the future."""


def url_of(hub: str | None) -> str:
    """The address that was asked for, as it was written."""
    return hub or os.environ.get(hub_address.ENVIRONMENT) or hub_address.DEFAULT


def reach(hub: str | None) -> HubClient | Finding:
    """A client to the hub, or why there is none."""
    elsewhere = f"tell where it is: {hub_address.ENVIRONMENT}=ws://HOST:PORT"
    try:
        return HubClient("doctor", hub)
    except (InvalidAddress, InvalidName):
        return wrong("hub", "Not looked for", "Mend the environment first, see above.")
    except NoHub as error:
        text = f"Nothing answers at {error.url} ({_source(hub)}; {error.cause})"
        return wrong("hub", text, f"Start one: {error.remedy}. Or {elsewhere}")
    except HubUnreachable as error:
        text = f"{error}. {answering(error.url)}"
        return wrong("hub", text, f"Look at what listens there, or {elsewhere}")


def _source(hub: str | None) -> str:
    if hub:
        return "--hub tells of it"
    is_set = os.environ.get(hub_address.ENVIRONMENT)
    return f"{hub_address.ENVIRONMENT} {'tells of it' if is_set else 'is not set'}"


def answering(url: str) -> str:
    """What a plain HTTP request tells of who is at an address."""
    try:
        status, headers, _ = _get(url, "/")
    except (OSError, ValueError):
        return "It does not answer HTTP either"
    server = headers.get("server", "")
    return f"It answers HTTP with {status}{f', as {server}' if server else ''}"


def version(url: str) -> Finding:
    """Whether it is a hub of fibws, and as new as this."""
    try:
        status, _, body = _get(url, "/healthz")
        if status == 403:  # A hub does not know all names of its machine, but it knows this one.
            status, _, body = _get(url, "/healthz", host="localhost")
    except (OSError, ValueError) as error:
        return warning(
            "version",
            f"{url} does not answer a plain HTTP request: {error}",
            "If something stands between, have it pass /healthz on.",
        )
    try:
        health: Any = json.loads(body)
        theirs = str(health["version"])
    except (ValueError, KeyError, TypeError):
        return warning(
            "version",
            f"/healthz there answers {status}, without a version: {_first_line(body)}",
            "If it is another rosbridge server than a fibws hub, not all tools can work with it.",
        )
    if theirs.split(".")[:2] == __version__.split(".")[:2]:
        return ok("version", f"The hub is fibws {theirs}, this is {__version__}")
    return warning(
        "version",
        f"The hub is fibws {theirs}, this is {__version__}",
        "Install one version at both ends: python -m pip install --upgrade fibws",
    )


def distance(client: HubClient) -> Iterator[Finding]:
    """How long an answer takes, and how far the clocks are apart.

    Raises:
        NodeError: the hub does not answer.
    """
    trips = []
    for _ in range(TRIPS):
        begun, wall = time.perf_counter(), time.time()
        answer = client.call("/rosapi/get_time")["time"]
        seconds = time.perf_counter() - begun
        theirs = answer["secs"] + answer["nsecs"] / 1e9
        trips.append((seconds, theirs - (wall + seconds / 2)))
    seconds, ahead = min(trips)  # Of the shortest trip, half is what is nearest to the way there.
    text = f"An answer takes {seconds * 1000:.1f} ms"
    if seconds <= SLOW_TRIP:
        yield ok("round trip", text)
    else:
        advice = "Is the network slow, or the hub busy? See: fibws top"
        yield warning("round trip", text, advice)
    yield clocks(ahead, seconds / 2)


def clocks(ahead: float, within: float) -> Finding:
    """How far the hub's clock is ahead, in seconds, as far as that can be told."""
    if abs(ahead) <= within:
        return ok("clock", f"The clocks agree within {within * 1000:.1f} ms")
    side = "ahead of" if ahead > 0 else "behind"
    text = f"The hub's clock is {abs(ahead):.3f} s {side} this machine's"
    if abs(ahead) - within <= CLOCKS:
        return ok("clock", text)
    return warning("clock", text, "Let both follow a time server (NTP), or stamps do not compare.")


def _get(url: str, path: str, host: str | None = None) -> tuple[int, dict[str, str], bytes]:
    from http.client import HTTPConnection, HTTPException, HTTPSConnection

    parts = urlsplit(url)
    kind = HTTPSConnection if parts.scheme == "wss" else HTTPConnection
    connection = kind(parts.hostname or "", parts.port, timeout=PATIENCE)
    try:
        connection.request("GET", path, headers={} if host is None else {"Host": host})
        response = connection.getresponse()
        headers = {name.lower(): value for name, value in response.getheaders()}
        return response.status, headers, response.read(65536)
    except HTTPException as error:
        raise ValueError(str(error) or type(error).__name__) from None
    finally:
        connection.close()


def _first_line(body: bytes) -> str:
    return body.decode(errors="replace").strip().partition("\n")[0][:80]
