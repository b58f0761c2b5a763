"""rosparam's functions for scripts: get, set, load and dump parameters.

Numbers may be written as angles: ``rad(pi/2)``, ``deg(90)``.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import rosgraph
from rosgraph.masterapi import reporting_no_master
from rosgraph.names import get_ros_namespace, make_global_ns, ns_join, script_resolve_name

from fibws.client.parameters import HubParameters
from fibws.errors import ParameterError, ServiceError

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
"""The key for the namespace of a document's parameters."""


class RosParamException(Exception):
    """The base of rosparam's errors."""


class RosParamIOException(RosParamException):
    """The hub cannot be reached."""


def load_file(
    filename: str | None, default_namespace: str | None = None, verbose: bool = False
) -> list[tuple[Any, str]]:
    """Return the parameters in a YAML file as `load_str` does; ``-`` is standard input.

    Raises:
        RosParamException: the file cannot be read, or its YAML is invalid.
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
    """Return the documents in a YAML text, each with the namespace of its parameters.

    Args:
        str: the text.
        filename: the text's source, for errors.
        default_namespace: the namespace of documents without ``_ns``; by default the program's.
        verbose: print namespaces.

    Raises:
        RosParamException: the YAML is invalid.
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
        raise RosParamException(f"[{filename}]: invalid YAML: {error}") from None
    return found


def upload_params(ns: str, values: Any, verbose: bool = False) -> None:
    """Set parameters; others in the namespace are kept.

    Args:
        ns: their namespace, or the name of one parameter.
        values: a dict of the parameters, or the value of one.
        verbose: print the parameters.

    Raises:
        RosParamException: the value for / is not a dict, a key is not a string, or a value is
            invalid.
        RosParamIOException: the hub cannot be reached.
    """
    if ns == "/" and not isinstance(values, dict):
        raise RosParamException("global / can only be set to a dictionary")
    if verbose:
        print_params(values, ns)
    set_param_raw(ns, values)


def get_param_server() -> rosgraph.Master:
    """Return the parameter server."""
    return rosgraph.Master("/rosparam")


def get_param(param: str) -> Any:
    """Return the value of a parameter, or a namespace as a dict.

    Raises:
        MasterError: the parameter is not set.
        RosParamIOException: the hub cannot be reached.
    """
    with reporting_no_master(RosParamIOException):
        return get_param_server().getParam(param)


def set_param(param: str, value: str, verbose: bool = False) -> None:
    """Set a parameter to a value in YAML; otherwise like `set_param_raw`."""
    import yaml

    try:
        read = yaml.load(value, _loader())
    except (yaml.YAMLError, ValueError) as error:
        raise RosParamException(f"invalid YAML {value!r}: {error}") from None
    set_param_raw(param, read, verbose)


def set_param_raw(param: str, value: Any, verbose: bool = False) -> None:
    """Set a parameter, or the parameters of a namespace from a dict.

    Args:
        verbose: print what is set.

    Raises:
        RosParamException: a key is not a string, or a value is invalid.
        RosParamIOException: the hub cannot be reached.
    """
    from fibws.client.hub_client import HubClient
    from fibws.values.parameter_files import leaves

    try:
        found = leaves(script_resolve_name("rosparam", param), value)
        with reporting_no_master(RosParamIOException), HubClient("rosparam") as client:
            for name, text in found:
                HubParameters(client.call).set_json(name, text)
                if verbose:
                    print(f"set parameter [{name}] to [{json.loads(text)}]")
    except ServiceError as error:
        raise RosParamException(error.text) from None
    except ParameterError as error:
        raise RosParamException(str(error)) from None


def delete_param(param: str, verbose: bool = False) -> None:
    """Delete a parameter or a namespace.

    Raises:
        MasterError: the parameter is not set.
        RosParamIOException: the hub cannot be reached.
    """
    with reporting_no_master(RosParamIOException):
        if param == "/":
            get_param_server().setParam(param, {})
        else:
            get_param_server().deleteParam(param)
    if verbose:
        print("deleted ENTIRE parameter server" if param == "/" else f"deleted parameter [{param}]")


def list_params(ns: str) -> list[str]:
    """Return the names of all parameters in a namespace, sorted.

    Raises:
        RosParamIOException: the hub cannot be reached.
    """
    above = make_global_ns(ns)
    with reporting_no_master(RosParamIOException):
        names = get_param_server().getParamNames()
    return sorted(name for name in names if name.startswith(above))


def dump_params(filename: str | None, param: str, verbose: bool = False) -> None:
    """Write a parameter or a namespace to a file, or to standard output for None.

    Raises:
        MasterError: the parameter is not set.
        RosParamIOException: the hub cannot be reached.
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
    """Print the values of parameters, one on each line."""
    if isinstance(params, dict):
        for key, value in params.items():
            print_params(value, ns_join(ns, key))
    else:
        print(f"{ns}={params}")


def _loader() -> Any:
    """Return the YAML loader of ``rosparam load``, which reads angles, too."""
    from fibws.values.parameter_files import loader

    return loader()
