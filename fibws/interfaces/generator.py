"""Writes the Python classes of a package's types, for editors, type checkers and people.

Two commands:

    python -m fibws.interfaces.generator
        writes fibws/msg/*.py, fibws/srv/*.py and fibws/action/*.py, as builds of fibws do
    python -m fibws.interfaces.generator --stubs FOLDER
        writes stubs of the user's packages, by which editors and type checkers know them
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TypeAlias

from fibws.errors import FibwsError, InterfaceError
from fibws.interfaces import class_source, generated_modules
from fibws.interfaces.catalogue import Interfaces
from fibws.interfaces.definition import MessageDefinition, ServiceDefinition
from fibws.interfaces.folders import Kind

_Classes: TypeAlias = dict[str, list[str]]
"""The lines of classes, in order, by their names."""

_PLURALS: dict[Kind, str] = {"msg": "messages", "srv": "services", "action": "actions"}


def generate(package: str, interfaces: Interfaces, kind: Kind = "msg") -> str:
    """The source of the module ``fibws.msg.<package>``, or of that in fibws.srv or fibws.action.

    Raises:
        InterfaceError: there is no such package, or one of its types is wrong.
    """
    match kind:
        case "msg":
            classes, imported = _messages(package, interfaces)
        case "srv":
            classes, imported = _services(package, interfaces)
        case "action":
            classes, imported = _actions(package, interfaces)
    body = [line for lines in classes.values() for line in ("", "", *lines)]
    return "\n".join([*_head(package, kind, imported, body), *_names(classes), *body, ""])


def _messages(package: str, interfaces: Interfaces) -> tuple[_Classes, set[str]]:
    """The classes of a package's messages, and the packages that those need."""
    definitions = _in_order(package, interfaces)
    classes = {
        found.name: list(class_source.message_class(found, package)) for found in definitions
    }
    return classes, _nested_packages(definitions) - {package}


def _services(package: str, interfaces: Interfaces) -> tuple[_Classes, set[str]]:
    """The classes of a package's services and of what they exchange, and the packages needed."""
    classes: _Classes = {}
    services = [interfaces.service(name) for name in interfaces.services(package)]
    for service in services:
        for name, lines in _service_classes(service):
            if name in classes:
                raise InterfaceError(f"Two classes would have the name {name} in {package}'s srv")
            classes[name] = list(lines)
    messages = (message for service in services for message in (service.request, service.response))
    return classes, _nested_packages(messages)


def _service_classes(service: ServiceDefinition) -> Iterator[tuple[str, Iterator[str]]]:
    for message in (service.request, service.response):
        yield message.name, class_source.message_class(message, home=None)
    yield service.name, class_source.service_class(service)


def _actions(package: str, interfaces: Interfaces) -> tuple[_Classes, set[str]]:
    """The classes of a package's actions, and the packages that those need."""
    actions = [interfaces.action(name) for name in interfaces.actions(package)]
    return {found.name: list(class_source.action_class(found)) for found in actions}, {package}


def _head(package: str, kind: Kind, imported: set[str], body: list[str]) -> Iterator[str]:
    plural = _PLURALS[kind]
    yield f'"""The {plural} of {package}, {generated_modules.GENERATED}"""'
    yield from ("", "from __future__ import annotations", "")
    typed = [
        each for each in ("ClassVar", "TypeAlias") if any(f": {each}" in line for line in body)
    ]
    if any(line.startswith("@dataclass") for line in body):
        has_fields = any("= field(" in line for line in body)
        yield f"from dataclasses import dataclass{', field' if has_fields else ''}"
    if typed:
        yield from (f"from typing import {', '.join(typed)}", "")
    yield "import fibws.interfaces as ros"
    # Not `from fibws.msg import`: pyright would look for stubs of the user's packages there alone.
    yield from (f"import fibws.msg.{each} as {each}" for each in sorted(imported))


def _names(classes: _Classes) -> Iterator[str]:
    yield from ("", "__all__ = [", *(f'    "{name}",' for name in sorted(classes)), "]")


def _in_order(package: str, interfaces: Interfaces) -> list[MessageDefinition]:
    """The package's messages by name, but each behind those of the package that it holds."""
    ordered: dict[str, MessageDefinition] = {}

    def add(name: str) -> None:
        definition = interfaces.message(name)
        for nested in _nested_types(definition):
            if nested.partition("/")[0] == package and nested not in ordered:
                add(nested)
        ordered.setdefault(name, definition)

    for name in interfaces.messages(package):
        add(name)
    return list(ordered.values())


def _nested_packages(definitions: Iterable[MessageDefinition]) -> set[str]:
    return {
        nested.partition("/")[0]
        for definition in definitions
        for nested in _nested_types(definition)
    }


def _nested_types(definition: MessageDefinition) -> Iterator[str]:
    return (field.type for field in definition.fields if field.is_nested)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the standard packages' modules, or stubs of the user's packages."""
    import argparse  # a node that imports a user's package has no use for it

    options = argparse.ArgumentParser(
        prog="python -m fibws.interfaces.generator",
        description="Write the Python classes of ROS messages, services and actions.",
    )
    options.add_argument(
        "--stubs",
        type=Path,
        metavar="FOLDER",
        help="write stubs (.pyi) of all your own packages into FOLDER; without, write the modules "
        "of the standard packages",
    )
    options.add_argument(
        "--interfaces",
        type=Path,
        action="append",
        metavar="FOLDER",
        help="folder of your own packages, or a package; can be repeated "
        "(default: those in FIBWS_INTERFACES)",
    )
    options.add_argument(
        "--into",
        type=Path,
        default=generated_modules.MODULES,
        metavar="FOLDER",
        help="write the standard packages' modules into the folders msg, srv and action of FOLDER "
        "(default: those of fibws)",
    )
    chosen = options.parse_args(arguments)
    try:
        if chosen.stubs is None:
            generated_modules.write_modules(chosen.into)
            return
        from fibws.definition_folders import named_folders
        from fibws.interfaces.stubs import write_stubs

        folders = chosen.interfaces or [Path(each) for each in named_folders()]
        for written in write_stubs(Interfaces(folders), chosen.stubs):
            print(written)
    except (FibwsError, OSError) as error:
        options.exit(1, f"{error}\n")


if __name__ == "__main__":
    main()
