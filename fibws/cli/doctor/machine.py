"""Whether this machine has what fibws needs: Python, packages, environment, terminal."""

from __future__ import annotations

import os
import platform
import re
import sys
from collections.abc import Iterator

from fibws import __version__, hub_address, names
from fibws.cli import output
from fibws.cli.doctor.finding import Finding, ok, warning, wrong
from fibws.errors import InvalidAddress, InvalidName

PYTHON = (3, 11)
PROXIES = ("https_proxy", "http_proxy", "all_proxy", "wss_proxy", "ws_proxy")
OF_ROS = ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME", "ROS_DOMAIN_ID")
"""What other ROS installations go by, and fibws does not."""


def checks(hub: str) -> Iterator[Finding]:
    """All that can be said without a hub.

    Args:
        hub: the address that was asked for, as it was written.
    """
    yield python(sys.version_info[:2])
    yield from packages()
    yield encoding()
    yield from environment(hub)


def python(version: tuple[int, int]) -> Finding:
    """Whether Python is new enough."""
    text = f"Python {platform.python_version()} on {platform.system()}"
    if version >= PYTHON:
        return ok("python", text)
    least = ".".join(map(str, PYTHON))
    return wrong("python", text, f"Install Python {least} or newer, and fibws with it.")


def packages() -> Iterator[Finding]:
    """Whether the packages that fibws needs are there, in versions that it can use."""
    from importlib import metadata

    try:
        needed = metadata.requires("fibws") or []
    except metadata.PackageNotFoundError:
        yield warning(
            "packages",
            f"fibws {__version__} is not installed, only found in a folder",
            "Install it: python -m pip install -e . in its checkout.",
        )
        return
    fine = [f"fibws {__version__}"]
    for requirement in needed:
        found = re.match(r"([\w.-]+)([^;]*)(;.*)?$", requirement)
        if found is None or found[3]:
            continue  # An extra's, or another system's.
        name, wanted = found[1], found[2].strip()
        try:
            version = metadata.version(name)
        except metadata.PackageNotFoundError:
            advice = f'Install it: python -m pip install "{name}{wanted}"'
            yield wrong("packages", f"{name} is not installed", advice)
            continue
        if fits(version, wanted):
            fine.append(f"{name} {version}")
        else:
            advice = f'Install one that does: python -m pip install "{name}{wanted}"'
            yield wrong("packages", f"{name} {version} does not fit, needed is {wanted}", advice)
    yield ok("packages", ", ".join(fine))


def fits(version: str, wanted: str) -> bool:
    """Whether a version is within bounds such as ``>=17.1,<18``; what is no bound, allows all."""
    is_met = {
        ">=": lambda left, right: left >= right,
        "<": lambda left, right: left < right,
    }
    return all(
        is_met[sign](_numbers(version), _numbers(bound))
        for sign, bound in re.findall(r"(>=|<)(?!=)\s*([\d.]+)", wanted)
    )


def encoding() -> Finding:
    """Whether what is printed can have more than ASCII."""
    name = output.encoding()
    if output.can_show("─✓é"):
        return ok("terminal", f"What is printed is {name}")
    return warning(
        "terminal",
        f"What is printed is {name}, which lacks characters of messages and drawings",
        "Set LANG=C.UTF-8, or PYTHONUTF8=1.",
    )


def environment(hub: str) -> Iterator[Finding]:
    """Whether environment variables are what they should be."""
    faults = [*_namespace(), *_address(hub), *_proxies(hub), *_of_ros()]
    yield from faults or [ok("environment", _told(hub))]


def _namespace() -> Iterator[Finding]:
    namespace = os.environ.get("ROS_NAMESPACE", "/")
    try:
        names.check_namespace(namespace)
    except InvalidName as error:
        yield wrong("environment", f"ROS_NAMESPACE: {error}", "Mend it, or: unset ROS_NAMESPACE")


def _address(hub: str) -> Iterator[Finding]:
    try:
        hub_address.hub_url(hub)
    except InvalidAddress as error:
        where = (
            hub_address.ENVIRONMENT if os.environ.get(hub_address.ENVIRONMENT) == hub else "--hub"
        )
        yield wrong("environment", f"{where}: {error}", f"Such as {hub_address.DEFAULT}.")


def _proxies(hub: str) -> Iterator[Finding]:
    found = [name for name in os.environ if name.lower() in PROXIES and os.environ[name]]
    if found and hub.startswith("wss:"):
        yield warning(
            "environment",
            f"{', '.join(sorted(found))} lead nodes to a wss:// hub by a proxy; tools go directly",
            "If the hub is not to be reached by the proxy, name its host in no_proxy.",
        )


def _of_ros() -> Iterator[Finding]:
    found = [name for name in OF_ROS if os.environ.get(name)]
    if found and not os.environ.get(hub_address.ENVIRONMENT):
        yield warning(
            "environment",
            f"{', '.join(found)} tell of another ROS, of which fibws knows nothing",
            f"To say where the hub is, set {hub_address.ENVIRONMENT}.",
        )


def _told(hub: str) -> str:
    known = (hub_address.ENVIRONMENT, "ROS_NAMESPACE", "FIBWS_INTERFACES")
    told = [f"{name}={os.environ[name]}" for name in known if os.environ.get(name)]
    if told:
        return ", ".join(told)
    so = f", so the hub is {hub}" if hub == hub_address.DEFAULT else ""
    return f"No variable of fibws is set{so}"


def _numbers(version: str) -> tuple[int, ...]:
    """``17.1.0`` is as new as ``17.1``; what follows the numbers, such as ``rc1``, is left out."""
    found = re.match(r"\d+(\.\d+)*", version)
    numbers = [int(part) for part in found[0].split(".")] if found else []
    while numbers and not numbers[-1]:
        numbers.pop()
    return tuple(numbers)
