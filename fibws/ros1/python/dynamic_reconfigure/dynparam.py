"""``rosrun dynamic_reconfigure dynparam``: read and change the parameters of servers."""

from __future__ import annotations

import argparse
import sys
from typing import Any

import rospy
import yaml

import dynamic_reconfigure
from dynamic_reconfigure.client import Client

FROM_PARAMETERS = """\
Set the values that the parameter server has below this program's own name, as in a launch file:

  <node name="adjust_camera" pkg="dynamic_reconfigure" type="dynparam"
        args="set_from_parameters camera">
    <param name="brightness" value="58"/>
  </node>
"""


def main() -> int:
    """Run one command; return the exit status."""
    words = _negative_numbers_as_values(rospy.myargv()[1:])
    options = _parser().parse_args(words)
    rospy.init_node("dynparam", anonymous=True)
    try:
        run: Any = globals()[f"_{options.command}"]
        return int(run(options) or 0)
    except dynamic_reconfigure.DynamicReconfigureParameterException as error:
        print(f"error updating parameters: {error}", file=sys.stderr)
    except rospy.ROSInterruptException:
        pass
    except (rospy.ROSException, dynamic_reconfigure.DynamicReconfigureException) as error:
        print(f"couldn't reach the parameters of node {options.node}: {error}", file=sys.stderr)
    except (OSError, yaml.YAMLError) as error:
        print(error, file=sys.stderr)
    return 1


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="dynparam", description="Read and change the parameters of configurable nodes."
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    raw = argparse.RawDescriptionHelpFormatter
    for name, help_ in (
        ("set", "configure a node"),
        ("set_from_parameters", "configure a node from the parameter server"),
        ("get", "print the configuration of a node"),
        ("load", "configure a node from a file"),
        ("dump", "write the configuration of a node to a file"),
        ("list", "list configurable nodes"),
    ):
        text = FROM_PARAMETERS if name == "set_from_parameters" else f"{help_.capitalize()}."
        command = commands.add_parser(name, help=help_, description=text, formatter_class=raw)
        if name == "list":
            continue
        seconds = "seconds to wait for the node; by default for ever"
        command.add_argument("-t", "--timeout", type=float, help=seconds)
        command.add_argument("node")
        if name == "set":
            what = "a parameter, or a YAML dictionary of values"
            command.add_argument("parameter", help=what)
            command.add_argument("value", nargs="?")
        elif name in ("load", "dump"):
            command.add_argument("file")
    return parser


def _negative_numbers_as_values(words: list[str]) -> list[str]:
    """Return the words with ``--`` before the first one that is a negative number."""
    for place, word in enumerate(words):
        if word[:1] == "-" and word[1:2].isdigit() and "--" not in words[:place]:
            return [*words[:place], "--", *words[place:]]
    return words


def _list(options: argparse.Namespace) -> None:
    for name in dynamic_reconfigure.find_reconfigure_services():
        print(name)


def _get(options: argparse.Namespace) -> int:
    config = Client(options.node, timeout=options.timeout).get_configuration(options.timeout)
    if config is None:
        print(f"couldn't get parameters from node {options.node}", file=sys.stderr)
        return 1
    print(config)
    return 0


def _set(options: argparse.Namespace) -> int:
    values = {options.parameter: options.value}
    if options.value is None:
        values = yaml.safe_load(options.parameter)
        if not isinstance(values, dict):
            text = f"expected a parameter and a value, or a YAML dictionary; got {values!r}"
            print(text, file=sys.stderr)
            return 2
    return _update(options, values)


def _set_from_parameters(options: argparse.Namespace) -> int:
    values = rospy.get_param("~", None)
    if not isinstance(values, dict):
        text = "error updating parameters: no parameters found on parameter server"
        print(text, file=sys.stderr)
        return 1
    return _update(options, values)


def _load(options: argparse.Namespace) -> int:
    values: dict[str, Any] = {}
    with open(options.file, encoding="utf-8") as file:
        for document in yaml.safe_load_all(file):
            values.update(document or {})
    return _update(options, values)


def _dump(options: argparse.Namespace) -> int:
    config = Client(options.node, timeout=options.timeout).get_configuration(options.timeout)
    if config is None:
        print(f"couldn't get parameters from node {options.node}", file=sys.stderr)
        return 1
    with open(options.file, "w", encoding="utf-8") as file:
        yaml.safe_dump({name: value for name, value in config.items() if name != "groups"}, file)
    return 0


def _update(options: argparse.Namespace, values: dict[str, Any]) -> int:
    Client(options.node, timeout=options.timeout).update_configuration(values)
    return 0


if __name__ == "__main__":
    sys.exit(main())
