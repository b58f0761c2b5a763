"""Checks of this machine: Python, packages, terminal, environment variables."""

from __future__ import annotations

import os
import platform
import socket
import sys
from collections.abc import Iterator
from urllib.parse import urlsplit

from fibws import __version__, credentials, hub_address, names, tls
from fibws.cli import output
from fibws.cli.doctor.finding import Finding, ok, warning, wrong
from fibws.credentials import Credentials
from fibws.errors import AccessError, InvalidAddress, InvalidName

PYTHON = (3, 11)
PROXIES = ("https_proxy", "http_proxy", "all_proxy", "wss_proxy", "ws_proxy")
MASTER_URI = "ROS_MASTER_URI"
ROS1_VARIABLES = (MASTER_URI, "ROS_IP", "ROS_HOSTNAME")
OTHER_ROS = ("ROS_DOMAIN_ID",)
"""Variables of other ROS installations, which fibws ignores."""


def checks(hub: str) -> Iterator[Finding]:
    """Yield the findings that need no hub.

    Args:
        hub: the hub's address as the user wrote it.
    """
    yield python(sys.version_info[:2])
    yield from packages()
    yield encoding()
    yield from environment(hub)


def python(version: tuple[int, int]) -> Finding:
    """Check the version of Python."""
    text = f"Python {platform.python_version()} on {platform.system()}"
    if version >= PYTHON:
        return ok("python", text)
    least = ".".join(map(str, PYTHON))
    return wrong("python", text, f"Install Python {least} or newer, and fibws in it.")


def packages() -> Iterator[Finding]:
    """Check the packages that fibws requires, and their versions."""
    from importlib import metadata

    from packaging.requirements import Requirement  # 40 ms

    try:
        requirements = [Requirement(each) for each in metadata.requires("fibws") or []]
    except metadata.PackageNotFoundError:
        yield warning(
            "packages",
            f"fibws {__version__} is imported from a folder and not installed",
            "Install it: python -m pip install -e . in its checkout.",
        )
        return
    fine = [f"fibws {__version__}"]
    for requirement in requirements:
        if requirement.marker is not None and not requirement.marker.evaluate({"extra": ""}):
            continue  # It belongs to an extra or to another system.
        name, expected = requirement.name, requirement.specifier
        advice = f'Install it: python -m pip install "{name}{expected}"'
        try:
            version = metadata.version(name)
        except metadata.PackageNotFoundError:
            yield wrong("packages", f"{name} is not installed", advice)
            continue
        if expected.contains(version, prereleases=True):
            fine.append(f"{name} {version}")
        else:
            yield wrong("packages", f"{name} {version} is installed, expected {expected}", advice)
    yield ok("packages", ", ".join(fine))


def encoding() -> Finding:
    """Check whether the output can have more than ASCII."""
    name = output.encoding()
    if output.can_show("─✓é"):
        return ok("terminal", f"The output's encoding is {name}")
    return warning(
        "terminal",
        f"The output's encoding is {name}, which lacks characters of messages and drawings",
        "Set LANG=C.UTF-8 or PYTHONUTF8=1.",
    )


def environment(hub: str) -> Iterator[Finding]:
    """Check the environment variables."""
    problems = [*_namespace(), *_address(hub), *_token(hub), *_proxies(hub), *_other_ros()]
    yield from problems or [ok("environment", _variables(hub))]


def _namespace() -> Iterator[Finding]:
    namespace = os.environ.get("ROS_NAMESPACE", "/")
    try:
        names.check_namespace(namespace)
    except InvalidName as error:
        yield wrong("environment", f"ROS_NAMESPACE: {error}", "Fix it, or: unset ROS_NAMESPACE")


def _address(hub: str) -> Iterator[Finding]:
    try:
        hub_address.hub_url(hub)
    except InvalidAddress as error:
        variable = hub_address.ENVIRONMENT
        where = variable if os.environ.get(variable) == hub else "--hub"
        yield wrong("environment", f"{where}: {error}", f"An example: {hub_address.DEFAULT}")


def _token(hub: str) -> Iterator[Finding]:
    try:
        Credentials.find(hub)
    except AccessError as error:
        advice = "Create a token at the hub's machine: fibws token add --help"
        yield wrong("environment", str(error), advice)


def _proxies(hub: str) -> Iterator[Finding]:
    found = [name for name in os.environ if name.lower() in PROXIES and os.environ[name]]
    if found and hub.startswith("wss:"):
        yield warning(
            "environment",
            f"{', '.join(sorted(found))}: nodes will use this proxy for a wss:// hub; "
            "tools connect directly",
            "To connect nodes directly as well, add the hub's host to no_proxy.",
        )


def _other_ros() -> Iterator[Finding]:
    found = [name for name in OTHER_ROS if os.environ.get(name)]
    if _master_host() not in (*hub_address.LOOPBACK, socket.gethostname()):
        found = [MASTER_URI, *found]
    if found and not os.environ.get(hub_address.ENVIRONMENT):
        yield warning(
            "environment",
            f"{', '.join(found)}: for other programs; nodes and commands of fibws ignore this",
            f"To set the hub's address: {hub_address.ENVIRONMENT}=ws://HOST:PORT",
        )


def _master_host() -> str:
    """Return the host of $ROS_MASTER_URI; this machine without one."""
    try:
        return urlsplit(os.environ.get(MASTER_URI, "")).hostname or "localhost"
    except ValueError:
        return "localhost"


def _variables(hub: str) -> str:
    known = (
        hub_address.ENVIRONMENT,
        *tls.VARIABLES,
        "ROS_NAMESPACE",
        "FIBWS_INTERFACES",
        credentials.TOKEN_FILE,
        *ROS1_VARIABLES,
    )
    variables = [
        f"{name}={hub_address.without_token(os.environ[name])}"
        for name in known
        if os.environ.get(name)
    ]
    if os.environ.get(credentials.TOKEN):
        variables.append(f"{credentials.TOKEN} is set")
    if variables:
        return ", ".join(variables)
    default = f"; the hub's address is {hub}" if hub == hub_address.DEFAULT else ""
    return f"No variables of fibws are set{default}"
