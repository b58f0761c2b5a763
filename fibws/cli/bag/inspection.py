"""``fibws bag info`` and ``fibws bag check``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from itertools import chain, islice
from typing import Any

import click

from fibws.bags import Connection, Reader
from fibws.bags.ros2_messages import ROS1
from fibws.cli import output
from fibws.cli.bag.bag_messages import BagType, open_bag
from fibws.cli.common_options import examples, json_option
from fibws.cli.exit_handling import clean_exit
from fibws.errors import BagError, InterfaceError, UnsupportedBag
from fibws.values.type_definitions import InstalledTypes

MOST_FAULTS = 20
"""Faults of a bag that are printed."""

bags_argument: Callable[[Callable[..., None]], Callable[..., None]] = click.argument(
    "bags", metavar="BAG...", nargs=-1, required=True, type=click.Path()
)


@click.command()
@bags_argument
@click.option("-y", "--yaml", "as_yaml", is_flag=True, help="Print YAML.")
@json_option
@click.option("-k", "--key", metavar="KEY", help="With --yaml, print only the value of KEY.")
@click.option("--freq", is_flag=True, help="Show the frequencies of topics.")
@examples(
    "{bag info} lab.bag",
    ("{bag info} -y -k duration lab.bag", "only the duration, for scripts"),
    ("{bag info} -y -k topics[0].messages lab.bag", ""),
)
def info(bags: tuple[str, ...], as_yaml: bool, as_json: bool, key: str | None, freq: bool) -> None:
    """Show the times, the size, the types and the topics of bags.

    The frequency of a topic is the inverse of the median of the periods between its messages.
    """
    if key is not None and not as_yaml:
        raise click.UsageError("You can only specify key when printing in YAML format: add --yaml.")
    from fibws.bags import summary

    def show(number: int, path: str) -> bool:
        if number and not as_json:
            output.line("---")
        with open_bag(path) as bag:
            if as_json:
                output.as_json(summary.as_dict(bag, path, frequencies=freq))
            elif key is not None:
                output.line(_value(summary.as_dict(bag, path, frequencies=freq), key))
            elif as_yaml:
                output.line(summary.as_yaml(summary.as_dict(bag, path, frequencies=freq)))
            else:
                output.line(summary.text(bag, path, frequencies=freq))
        return True

    _for_each(bags, show)


def _for_each(bags: tuple[str, ...], inspect: Callable[[int, str], bool]) -> None:
    """Inspect bags; go on after one that cannot be read, and exit with 1 in the end.

    Args:
        inspect: takes the number of a bag and its path; returns whether it is valid.
    """
    are_valid = True
    with clean_exit():
        for number, bag in enumerate(bags):
            try:
                are_valid &= inspect(number, bag)
            except click.UsageError:
                raise
            except (BagError, click.ClickException) as error:
                click.echo(output.visible(f"Error: {error}"), err=True)
                are_valid = False
    if not are_valid:
        raise click.exceptions.Exit(1)


def _value(found: dict[str, Any], key: str) -> str:
    """Return the value of a key such as ``topics[0].type`` as rosbag prints it."""
    from fibws.bags import summary
    from fibws.errors import InvalidValue
    from fibws.suggestions import suggestion

    try:
        return summary.value_text(found, key)
    except summary.UnknownKey as error:
        near = suggestion(error.name, error.known) if error.known else ""
        raise InvalidValue(f"--key: the bag has no {key!r}{near}") from None


@click.command()
@bags_argument
@click.option("-g", "--genrules", metavar="FILE", help="Not supported: fibws has no rule files.")
@click.option("-a", "--append", is_flag=True, help="Not supported: fibws has no rule files.")
@click.option(
    "-n", "--noplugins", is_flag=True, help="Ignored; accepted for compatibility with rosbag."
)
@examples("{bag check} lab.bag", "{bag check} recordings/*.bag")
def check(bags: tuple[str, ...], genrules: str | None, append: bool, noplugins: bool) -> None:
    """Check that each BAG can be read, and that its types are those that are installed.

    The whole file is read: definitions must be valid, all messages must fit them, the index must
    agree with what is there, and times must be plausible: not 0, nor years apart. The exit code is
    1 if there is a fault.

    Messages of a type that has changed cannot be received by nodes that know the new one. Types
    that are not installed are listed, too; they can be played, as the bag has their definitions.
    """
    if genrules or append or any(each.endswith(".bmr") for each in bags):
        raise click.UsageError("rules of migration are not supported; rosbag of ROS 1 has them")

    def check_one(_: int, bag: str) -> bool:
        if len(bags) > 1:
            output.line(f"{bag}:")
        return _check(bag)

    _for_each(bags, check_one)


def _check(bag: str) -> bool:
    """Print what is wrong with a bag, or how its types differ; return whether it is valid."""
    with open_bag(bag) as reader:
        types, notes = dict[int, BagType](), list[str]()
        found = chain(reader.faults(), _message_faults(reader, types, notes))
        faults = list(islice(found, MOST_FAULTS))
        if faults:
            for each in faults:
                click.echo(output.visible(f"{bag}: {each}"), err=True)
            return False
        for note in notes:
            output.line(f"Not checked: {note}")
        changed = {
            types[each.id].name: types[each.id].md5sum
            for each in reader.connections
            if each.id in types and not _is_installed(each, types[each.id])
        }
        if not changed:
            output.line("Bag file does not need any migrations.")
            return True
        output.line("The following migrations need to occur:")
        for name, md5sum in sorted(changed.items()):
            known = _installed_md5(name)
            output.line(f" * From: {name} [{md5sum}]")
            output.line(f"   To:   {f'{name} [{known}]' if known else 'Unknown'}")
        return True


def _message_faults(reader: Reader, types: dict[int, BagType], notes: list[str]) -> Iterator[str]:
    """Say which definitions are invalid, and which connections have messages that do not fit.

    Args:
        types: gets the types of the other connections, by their ids.
        notes: gets what says which messages cannot be read here.
    """
    for connection in reader.connections:
        try:
            found = BagType(connection)
            found.serializer  # noqa: B018 - it raises for an invalid definition
            types[connection.id] = found
        except UnsupportedBag as error:
            notes.append(str(error))
        except BagError as error:
            yield str(error)
    for connection, _, data in reader.messages():
        if connection.id in types:
            try:
                types[connection.id].check(data)
            except BagError as error:
                del types[connection.id]
                yield str(error)


def _is_installed(connection: Connection, type_: BagType) -> bool:
    installed = _installed_md5(type_.name)
    if connection.encoding != ROS1 and installed is None:
        return True  # ROS 1 has no such type to differ from.
    return type_.md5sum in ("*", installed)


@cache
def _installed_md5(type_: str) -> str | None:
    """Return the md5sum of a type on this machine, or None if it is unknown."""
    try:
        return InstalledTypes("msg").md5(type_)
    except InterfaceError:
        return None
