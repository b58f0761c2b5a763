"""What scripts do with parameters by files: ``rosparam.load_file`` and ``rosparam.upload_params``.

Numbers may be written as angles: ``rad(pi/2)``, ``deg(90)``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import rosgraph
from rosgraph.names import get_ros_namespace, make_global_ns, ns_join, script_resolve_name

from fibws.errors import HubUnreachable, ParameterError, ServiceError

__all__ = [
    "RosParamException",
    "RosParamIOException",
    "delete_param",
    "dump_params",
    "get_param",
    "get_param_server",
    "list_params",
    "load_file",
    "load_str",
    "print_params",
    "set_param",
    "set_param_raw",
    "upload_params",
]

NAMESPACE = "_ns"
"""The key by which a document names the namespace of its parameters."""


class RosParamException(Exception):
    """The base of what goes wrong here."""


class RosParamIOException(RosParamException):
    """There is no hub."""


def load_file(
    filename: str | None, default_namespace: str | None = None, verbose: bool = False
) -> list[tuple[Any, str]]:
    """The parameters in a YAML file, as `load_str` gives them; ``-`` is the standard input.

    Raises:
        RosParamException: there is no such file, or it is no YAML.
    """
    if not filename or filename == "-":
        if verbose:
            print("reading parameters from stdin")
        return load_str(sys.stdin.read(), "stdin", default_namespace, verbose)
    try:
        with open(filename, encoding="utf-8") as file:
            text = file.read()
    except FileNotFoundError:
        raise RosParamException(f"file [{filename}] does not exist") from None
    except (OSError, UnicodeDecodeError) as error:
        raise RosParamException(f"file [{filename}] cannot be read: {error}") from None
    if verbose:
        print(f"reading parameters from [{filename}]")
    return load_str(text, filename, default_namespace, verbose)


def load_str(
    str: str, filename: str, default_namespace: str | None = None, verbose: bool = False
) -> list[tuple[Any, str]]:
    """The parameters in a text: each document in it, with the namespace that it belongs in.

    Args:
        str: the text, in YAML.
        filename: where it is from, for errors.
        default_namespace: the namespace of documents that name none by ``_ns``; else the program's.
        verbose: whether namespaces are printed.

    Raises:
        RosParamException: it is no YAML.
    """
    import yaml

    found: list[tuple[Any, Any]] = []
    above = default_namespace or get_ros_namespace()
    try:
        for document in yaml.load_all(str, _loader()):
            namespace = above
            if isinstance(document, dict) and NAMESPACE in document:
                namespace = ns_join(above, document.pop(NAMESPACE))
                if verbose:
                    print(f"reading parameters into namespace [{namespace}]")
            found.append((document, namespace))
    except (yaml.YAMLError, ValueError) as error:
        raise RosParamException(f"[{filename}] is no YAML: {error}") from None
    return found


def upload_params(ns: str, values: Any, verbose: bool = False) -> None:
    """Set parameters; what else there is in the namespace stays.

    Args:
        ns: their namespace, or the name of one parameter.
        values: a dict of them, or the value of the one.
        verbose: whether they are printed.

    Raises:
        RosParamException: what is in / is no dict, a key is no text, or a value is none that a
            parameter can have.
        RosParamIOException: there is no hub.
    """
    if ns == "/" and not isinstance(values, dict):
        raise RosParamException("global / can only be set to a dictionary")
    if verbose:
        print_params(values, ns)
    set_param_raw(ns, values)


def get_param_server() -> rosgraph.Master:
    """What parameters are asked of."""
    return rosgraph.Master("/rosparam")


def get_param(param: str) -> Any:
    """The value of a parameter, or all of a namespace as a dict.

    Raises:
        MasterError: there is none.
        RosParamIOException: there is no hub.
    """
    with _communicating():
        return get_param_server().getParam(param)


def set_param(param: str, value: str, verbose: bool = False) -> None:
    """Set a parameter to a value in YAML; else as `set_param_raw`."""
    import yaml

    try:
        read = yaml.load(value, _loader())
    except (yaml.YAMLError, ValueError) as error:
        raise RosParamException(f"{value!r} is no YAML: {error}") from None
    set_param_raw(param, read, verbose)


def set_param_raw(param: str, value: Any, verbose: bool = False) -> None:
    """Set a parameter, or all that a dict has in a namespace.

    Args:
        verbose: whether that is printed.

    Raises:
        RosParamException: a key is no text, or a value is none that a parameter can have.
        RosParamIOException: there is no hub.
    """
    from fibws.client.hub_client import HubClient
    from fibws.values.parameter_files import leaves

    try:
        found = leaves(script_resolve_name("rosparam", param), value)
    except ParameterError as error:
        raise RosParamException(str(error)) from None
    with _communicating(), HubClient("rosparam") as link:
        for name, text in found:
            link.call("/rosapi/set_param", {"name": name, "value": text})
            if verbose:
                print(f"set parameter [{name}] to [{json.loads(text)}]")


def delete_param(param: str, verbose: bool = False) -> None:
    """Delete a parameter, or all of a namespace.

    Raises:
        MasterError: there is none.
        RosParamIOException: there is no hub.
    """
    with _communicating():
        if param == "/":
            get_param_server().setParam(param, {})
        else:
            get_param_server().deleteParam(param)
    if verbose:
        print("deleted ENTIRE parameter server" if param == "/" else f"deleted parameter [{param}]")


def list_params(ns: str) -> list[str]:
    """The names of all parameters in a namespace, sorted.

    Raises:
        RosParamIOException: there is no hub.
    """
    above = make_global_ns(ns)
    with _communicating():
        names = get_param_server().getParamNames()
    return sorted(name for name in names if name.startswith(above))


def dump_params(filename: str | None, param: str, verbose: bool = False) -> None:
    """Write a parameter, or all of a namespace, to a file; else to the standard output.

    Raises:
        MasterError: there is none.
        RosParamIOException: there is no hub.
    """
    import yaml

    tree = get_param(param)
    if verbose:
        print_params(tree, param)
    if not filename:
        yaml.safe_dump(tree, sys.stdout)
        return
    with open(filename, "w", encoding="utf-8") as file:
        yaml.safe_dump(tree, file)


def print_params(params: Any, ns: str) -> None:
    """Print the values of parameters, one in a line."""
    if isinstance(params, dict):
        for key, value in params.items():
            print_params(value, ns_join(ns, key))
    else:
        print(f"{ns}={params}")


def _loader() -> Any:
    """How YAML is read, angles too; numbers are what ``rosparam load`` takes them for."""
    from fibws.values.parameter_files import loader

    return loader()


@contextmanager
def _communicating() -> Iterator[None]:
    try:
        yield
    except (OSError, HubUnreachable) as error:
        raise RosParamIOException(f"Unable to communicate with master! {error}") from None
    except ServiceError as error:
        raise RosParamException(error.text) from None
