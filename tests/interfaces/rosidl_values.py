"""Lines with values of ROS 2, and what rosidl_adapter makes of them.

The answers are in ``answers/rosidl_values.json``. With a checkout of github.com/ros2/rosidl (pure
Python), this asks again:

    PYTHONPATH=rosidl/rosidl_adapter python tests/interfaces/rosidl_values.py
"""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import Any

ANSWERS = Path(__file__).with_name("answers") / "rosidl_values.json"

_STRINGS = [
    *("plain", "two words", "'it'", '"it"', r"'it\'s'", r'"say \"hi\""', "'say \"hi\"'", '"it\'s"'),
    *("''", '""', "' a '", r"'a\nb'", r'"a\\b"', "'a'b'", '"a"b"', "5", "true", "abc", "abcd"),
]
_INTEGERS = [
    *("0", "-0", "+5", "5", "-5", "007", "0x10", "0XFF", "-0x1F", "0b0101", "0B11", "0o17", "0O7"),
    *("127", "128", "200", "255", "256", "-1", "-128", "-129", "1_000", "1.0", "1e3", "true", ""),
    *("65535", "65536", "4294967295", "4294967296", "18446744073709551615", "9223372036854775808"),
    *("five", "0x", "0b2", "0o8", "1 2", "--1", "'1'", "0_0"),
]
_FLOATS = [
    *("1", "1.", ".5", "1.5", "-1.5e3", "1E-3", "+1.", "1,5", "0x10", "one", "1_0.5", "."),
    *("1e400", "-0.0"),
]
_BOOLEANS = ["true", "false", "True", "False", "TRUE", "FALSE", "tRuE", "1", "0", "2", "yes", "''"]
_ARRAYS = [
    *(f"int32[] x {text}" for text in ("[1, -2]", "[]", "[0x10, -1]", "[0b11,0o17]", "[ 1 ,2 ]")),
    *(f"int32[] x {text}" for text in ("[1", "1", "[1 2]", "[1,]", "[,]", "[1.5]", "['1']")),
    *("int32[2] x [1, 2]", "int32[2] x [1]", "int32[<=2] x [1]", "int32[<=2] x [1, 2, 3]"),
    *("float64[] x [1., .5]", "float32[3] x [0, 1, -2.5e3]", "float64[] x [one]"),
    *("bool[] x [True, False]", "bool[] x [true, 0, FALSE]", "bool[2] x [1, 2]"),
    *("byte[] x [0, 255]", "byte[] x [256]", "uint8[] x [0, 0xff]", "char[] x [65]"),
    *("string[] x ['a', 'b']", "string[] x [a, b]", "string[] x [\"a\", 'b']", "string[] x []"),
    *("string[] x ['a, b', c]", r"string[] x ['it\'s', 'b']", r'string[] x ["say \"hi\""]'),
    *("string[] x [one two, three]", "string[] x ['']", "string[] x ['a','b','c']"),
    *("string[] x ['a", "string[] x [,]", "string[2] x ['a']", "string[<=1] x ['a', 'b']"),
    *("string<=2[] x ['ab']", "string<=2[] x ['abc']", "wstring[] x ['a']"),
]
LINES = [
    *(f"string x {text}" for text in _STRINGS),
    *(f"string<=3 x {text}" for text in _STRINGS),
    *(f"string X={text}" for text in _STRINGS),
    *(f"wstring X= {text}" for text in _STRINGS[:4]),
    *(
        f"{kind} {member}{text}"
        for kind in ("byte", "char", "int8", "uint8", "uint16", "uint32", "int64", "uint64")
        for text in _INTEGERS
        for member in ("x ", "X=")
    ),
    *(
        f"{kind} {name}{text}"
        for kind in ("float32", "float64")
        for text in _FLOATS
        for name in ("x ", "X=")
    ),
    *(f"bool {name}{text}" for text in _BOOLEANS for name in ("x ", "X=")),
    *_ARRAYS,
]


def _answer(line: str) -> Any:
    """Return the value that rosidl_adapter reads, in a list; None if it refuses the line."""
    parser = import_module("rosidl_adapter.parser")
    try:
        found = parser.parse_message_string("my_msgs", "Mine", line)
    except Exception:
        return None
    members = [*found.fields, *found.constants]
    return [getattr(each, "default_value", getattr(each, "value", None)) for each in members]


if __name__ == "__main__":
    answers = {line: _answer(line) for line in LINES}
    rows = ",\n".join(f"{json.dumps(line)}: {json.dumps(found)}" for line, found in answers.items())
    ANSWERS.write_text(f"{{\n{rows}\n}}\n")
