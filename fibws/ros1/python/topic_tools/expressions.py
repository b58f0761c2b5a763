"""transform and relay_field: topics computed from others; the first argument is the program.

Source: topic_tools of ROS Noetic. Expressions are Python, in which ``m`` is the message, or the
field that the input names. They are those of the person who starts the program, and do what that
person may do.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any

import genpy
import roslib.message
import rospy
import rostopic
import yaml
from std_msgs.msg import Header

Compute = Callable[[Any], Any]
"""Returns the message to publish for an input."""


def main(program: str, arguments: Sequence[str]) -> None:
    """Run a program with its arguments until the node ends."""
    options = _parser(program).parse_args(arguments)
    rospy.init_node(program, anonymous=True)
    # Names are those of a program in the node's namespace, as on a command line.
    topic = rospy.get_namespace() + options.input if options.input[0] != "/" else options.input
    input_class, input_topic, field = rostopic.get_topic_class(
        topic, blocking=options.wait_for_start
    )
    if input_topic is None or input_class is None:
        sys.exit(f"ERROR: Wrong input topic (or topic field): {topic}")
    output_class = roslib.message.get_message_class(options.output_type)
    if output_class is None:
        sys.exit(f"ERROR: unknown type of the output: {options.output_type}")
    compute = (
        _transform(options.expression, options.modules, output_class)
        if program == "transform"
        else _relay_field(options.expression, output_class)
    )
    latch = getattr(options, "latch", False)
    publisher = rospy.Publisher(options.output_topic, output_class, latch=latch, queue_size=1)

    def receive(message: Any) -> None:
        value = message if field is None else field(message)
        try:
            result = compute(value)
        except Exception as error:
            text = f"{options.expression}: {type(error).__name__}: {error}"
            rospy.logerr_throttle_identical(10, text)
        else:
            publisher.publish(result)

    rospy.Subscriber(input_topic, input_class, receive)
    rospy.spin()


def _transform(expression: str, names: Sequence[str], output_class: Any) -> Compute:
    """Return a function that evaluates an expression: a field, or a list of all fields."""
    modules = {}
    for name in names:
        try:
            import_module(name)
        except ImportError as error:
            if names is not _MODULES:
                print(f"Failed to import module: {name} ({error})", file=sys.stderr)
        else:
            top = name.partition(".")[0]
            modules[top] = sys.modules[top]
    code = _compiled(expression)

    def compute(message: Any) -> Any:
        result = eval(code, {**modules, "m": message})
        if isinstance(result, output_class):
            return result
        return output_class(*(result if isinstance(result, list | tuple) else [result]))

    return compute


def _relay_field(expression: str, output_class: Any) -> Compute:
    """Return a function that fills the fields of YAML whose texts may be expressions."""
    try:
        fields = yaml.safe_load(expression)
    except yaml.YAMLError as error:
        sys.exit(f"ERROR: invalid YAML: {error}")
    if not isinstance(fields, dict):
        sys.exit(f"ERROR: expected fields as YAML, such as 'data: m.x', got {expression!r}")

    def compute(message: Any) -> Any:
        now = rospy.get_rostime()
        result = output_class()
        keys = {"now": now, "auto": Header(stamp=now)}
        genpy.message.fill_message_args(result, [_evaluated(fields, message)], keys=keys)
        return result

    return compute


def _evaluated(fields: Mapping[str, Any], message: Any) -> dict[str, Any]:
    """Return fields with the values of their expressions; other texts stay as they are."""
    found = {}
    for name, value in fields.items():
        if isinstance(value, dict):
            value = _evaluated(value, message)
        elif isinstance(value, str):
            try:
                value = eval(value, {"m": message})
            except (NameError, SyntaxError):
                pass
        found[name] = value
    return found


def _compiled(expression: str) -> Any:
    try:
        return compile(expression.strip(), "<expression>", "eval")
    except SyntaxError as error:
        sys.exit(f"ERROR: invalid expression {expression!r}: {error.msg}")


_MODULES = ["numpy"]
"""What transform imports if nothing else is asked for, and it is installed."""


def _parser(program: str) -> argparse.ArgumentParser:
    is_transform = program == "transform"
    parser = argparse.ArgumentParser(
        program,
        description="Publish a topic that is computed from another one.",
        epilog="example: "
        + (
            "transform /imu/orientation /norm std_msgs/Float64 "
            "'numpy.linalg.norm([m.x, m.y, m.z, m.w])' --import numpy"
            if is_transform
            else "relay_field /chatter /header std_msgs/Header 'frame_id: m.data'"
        ),
    )
    parser.add_argument("input", help="topic, or topic and field: /imu/orientation/x")
    parser.add_argument("output_topic", help="topic to publish")
    parser.add_argument("output_type", help="its type: std_msgs/Float64")
    parser.add_argument("--wait-for-start", action="store_true", help="wait for the input topic")
    parser.add_argument("--tcpnodelay", action="store_true", help="ignored")
    if not is_transform:
        parser.add_argument("expression", help="fields as YAML; their texts are Python, with m")
        return parser
    parser.add_argument(
        "expression", nargs="?", default="m", help="Python expression of the fields, with m"
    )
    parser.add_argument(
        *("-i", "--import"),
        dest="modules",
        nargs="+",
        default=_MODULES,
        help="modules for the expression (default: numpy)",
    )
    parser.add_argument("--latch", action="store_true", help="latch the output")
    return parser


if __name__ == "__main__":
    words = rospy.myargv()[1:]
    main(words[0], words[1:])
