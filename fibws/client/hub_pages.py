"""The hub's answers by HTTP: its page, its state, and the port of its ROS 1 master."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http.client import HTTPConnection, HTTPException, HTTPSConnection
from urllib.parse import urlsplit

from fibws import hub_address, tls
from fibws.errors import FibwsError

MASTER_URI = "ROS_MASTER_URI"
"""The variable by which nodes of an installed ROS 1 find their master."""
PATIENCE = 3.0
"""Seconds to wait for an answer."""
LARGEST = 65536
"""Bytes of an answer that are read."""


def get(
    url: str, path: str, headers: Mapping[str, str] | None = None
) -> tuple[int, dict[str, str], bytes]:
    """Return the status, the headers and the body of a page.

    Args:
        url: the hub's URL.
        path: the page's path, without a slash in front.
        headers: of the request, such as those of a token.

    Raises:
        OSError: the hub does not answer.
        ValueError: it does not speak HTTP.
    """
    found = _get(url, path, headers or {})
    if found[0] == 403:  # The hub may not accept this name of its machine.
        return _get(url, path, {"Host": "localhost", **(headers or {})})
    return found


def ros1_port(url: str) -> int | None:
    """Return the port of a hub's ROS 1 master.

    It is None if the hub has no master, does not answer, or shows it only to admins.
    """
    try:
        _, _, body = get(url, "healthz")
        port = json.loads(body).get("ros1_port")
    except (OSError, ValueError, AttributeError, FibwsError):
        return None
    return port if isinstance(port, int) else None


def master_variables(url: str, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables with which programs of an installed ROS 1 join a hub's graph.

    They are empty if the hub is not a ROS 1 master, or the environment names its port already.

    Args:
        url: the hub's URL.
        environment: the present variables.
    """
    port = ros1_port(url)
    if port is None or _port(environment.get(MASTER_URI, "")) == port:
        return {}
    host = urlsplit(url).hostname or ""
    host = "localhost" if hub_address.is_loopback(host) else f"[{host}]" if ":" in host else host
    return {MASTER_URI: f"http://{host}:{port}"}


def _port(uri: str) -> int | None:
    try:
        return urlsplit(uri).port
    except ValueError:
        return None


def _get(url: str, path: str, sent: Mapping[str, str]) -> tuple[int, dict[str, str], bytes]:
    parts = urlsplit(hub_address.page_url(url, path))
    connection = HTTPConnection(parts.hostname or "", parts.port, timeout=PATIENCE)
    if parts.scheme == "https":
        context = tls.TlsFiles.choose().context(url)
        connection = HTTPSConnection(
            parts.hostname or "", parts.port, timeout=PATIENCE, context=context
        )
    try:
        connection.request("GET", parts.path, headers=dict(sent))
        response = connection.getresponse()
        headers = {name.lower(): value for name, value in response.getheaders()}
        return response.status, headers, response.read(LARGEST)
    except HTTPException as error:
        raise ValueError(str(error) or type(error).__name__) from None
    finally:
        connection.close()
