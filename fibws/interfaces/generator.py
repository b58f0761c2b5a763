"""Writes the Python classes of a package's messages, for editors, type checkers and people.

Two commands:

    python -m fibws.interfaces.generator                                writes fibws/msg/*.py anew
    python -m fibws.interfaces.generator --interfaces FOLDER PACKAGE    prints one of the user's own
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path

from fibws.errors import FibwsError
from fibws.interfaces import builtin
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import Constant, Field, MessageDefinition, Scalar
from fibws.interfaces.message import python_name

MODULES = Path(__file__).parents[1] / "msg"
"""Where the modules of the standard packages are."""

LINE_LENGTH = 100


def generate(package: str, interfaces: Interfaces) -> str:
    """The source of the module ``fibws.msg.<package>``.

    Raises:
        InterfaceError: there is no such package, or one of its messages is wrong.
    """
    definitions = _in_order(package, interfaces)
    others = {
        _package_of(field)
        for definition in definitions
        for field in definition.fields
        if field.is_nested and _package_of(field) != package
    }
    lines = [
        f'"""The messages of {package}, written by fibws.interfaces.generator: do not edit."""',
        "",
        "from __future__ import annotations",
        "",
        "from dataclasses import dataclass, field",
        "from typing import ClassVar",
        "",
        "import fibws.interfaces as ros",
        *([f"from fibws.msg import {', '.join(sorted(others))}"] if others else []),
        "",
        "__all__ = [",
        *(f'    "{name}",' for name in sorted(definition.name for definition in definitions)),
        "]",
    ]
    for definition in definitions:
        lines += ["", "", *_class(definition)]
    return "\n".join(lines) + "\n"


def _in_order(package: str, interfaces: Interfaces) -> list[MessageDefinition]:
    """The package's messages by name, but each behind those of the package that it holds."""
    ordered: dict[str, MessageDefinition] = {}

    def add(name: str) -> None:
        definition = interfaces.message(name)
        for field in definition.fields:
            if field.is_nested and _package_of(field) == package and field.type not in ordered:
                add(field.type)
        ordered.setdefault(name, definition)

    for name in interfaces.messages(package):
        add(name)
    return list(ordered.values())


def _class(definition: MessageDefinition) -> Iterator[str]:
    yield "@dataclass(slots=True, eq=False, repr=False)"
    yield f"class {definition.name}(ros.Message):"
    yield f'    """{definition.type}"""'
    yield ""
    yield f'    _type: ClassVar[str] = "{definition.type}"'
    for constant in definition.constants:
        yield f"    {_constant(constant)}"
    if definition.fields:
        yield ""
    for field in definition.fields:
        line = f"    {_field(field, definition.package)}"
        if len(line) > LINE_LENGTH:
            line = line.replace("= field(", "= field(\n        ")[:-1] + "\n    )"
        yield line


def _constant(constant: Constant) -> str:
    annotation = type(constant.value).__name__
    return f"{python_name(constant.name)}: ClassVar[{annotation}] = {_literal(constant.value)}"


def _field(field: Field, package: str) -> str:
    name, element = python_name(field.name), _element(field, package)
    if field.is_bytes:
        return f"{name}: bytes = {_bytes(field)}"
    if field.array is not None:
        return f"{name}: list[{element}] = field(default_factory={_list(field, element)})"
    if field.type in builtin.CONSTANTS:
        return f"{name}: {element} = {_literal(field.default_value)}"
    # A lambda looks later, and in the module: in the class a member may have the nested class's
    # name, and another package may not be loaded yet, if it imports this one in its turn.
    factory = f"lambda: {element}()" if field.is_nested else element
    return f"{name}: {element} = field(default_factory={factory})"


def _element(field: Field, package: str) -> str:
    """The Python type of the field, or of one element if it is an array."""
    if field.type in builtin.TIMES:
        return f"ros.{field.type.capitalize()}"
    if field.is_nested:
        other, _, name = field.type.partition("/")
        return name if other == package else f"{other}.{name}"
    return type(builtin.zero(field.type)).__name__


def _bytes(field: Field) -> str:
    if field.default is None:
        return f"bytes({field.fixed_size})" if field.fixed_size else 'b""'
    return f"bytes({list(field.default_elements)})"


def _list(field: Field, element: str) -> str:
    """A function that makes the list that the array is unless told otherwise."""
    if field.default is not None:
        return f"lambda: [{', '.join(map(_literal, field.default_elements))}]"
    if not field.fixed_size:
        return "list"
    if field.type in builtin.CONSTANTS:
        return f"lambda: [{_literal(builtin.zero(field.type))}] * {field.fixed_size}"
    return f"lambda: [{element}() for _ in range({field.fixed_size})]"


def _literal(value: Scalar) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, float) and not isfinite(value):
        return f'float("{value}")'
    return repr(value)


def _package_of(field: Field) -> str:
    return field.type.partition("/")[0]


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the standard packages' modules, or print that of one package."""
    import argparse  # a node that imports a user's package has no use for it

    options = argparse.ArgumentParser(
        prog="python -m fibws.interfaces.generator",
        description="Write the Python classes of ROS messages.",
    )
    options.add_argument("--interfaces", type=Path, action="append", default=[], metavar="FOLDER")
    options.add_argument("package", nargs="?", help="print its module; without: write fibws/msg")
    chosen = options.parse_args(arguments)
    try:
        interfaces = Interfaces(chosen.interfaces)
        if chosen.package is not None:
            print(generate(chosen.package, interfaces), end="")
            return
        for package in Interfaces().packages():
            if interfaces.messages(package):
                (MODULES / f"{package}.py").write_text(generate(package, interfaces), "utf-8")
    except FibwsError as error:
        options.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
