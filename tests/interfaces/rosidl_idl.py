"""Definitions of ROS 2, and the IDL that rosidl_adapter makes of them.

The answers are in ``answers/rosidl_idl.json``. With a checkout of github.com/ros2/rosidl (pure
Python, which needs empy 3), this asks again:

    PYTHONPATH=rosidl/rosidl_adapter python tests/interfaces/rosidl_idl.py
"""

from __future__ import annotations

import json
import tempfile
from importlib import import_module
from pathlib import Path

ANSWERS = Path(__file__).with_name("answers") / "rosidl_idl.json"
PACKAGE = "garden_msgs"

DEFINITIONS = {
    "msg/Empty": "",
    "msg/Constants": "# Kinds of plants.\nuint8 TREE=1\nint64 LOW=-9223372036854775808\n"
    "float32 HALF=0.5\nfloat64 BIG=1e300\nbool YES=true\nstring NAME='it\\'s \"it\"'\n"
    "byte MASK=255\nuint16 HEX=0x10\n",
    "msg/Numbers": "bool a\nbyte b\nint8 c\nuint8 d\nint16 e\nuint16 f\nint32 g\nuint32 h\n"
    "int64 i\nuint64 j\nfloat32 k\nfloat64 l\n",
    "msg/Texts": "string a\nstring<=5 b\nwstring c\nstring[] d\nstring<=3[2] e\nstring<=3[<=4] f\n"
    "wstring[<=2] g\n",
    "msg/Arrays": "float64[36] covariance\nfloat64[9] k\nint32[] any\nuint8[<=10] some\n"
    "Numbers[] rows\nNumbers[3] three\nNumbers one\nstd_msgs/Header header\n"
    "geometry_msgs/Point[<=2] points\nbuiltin_interfaces/Time stamp\n"
    "builtin_interfaces/Duration[] waits\n",
    "msg/Defaults": "bool a true\nint8 b -5\nuint64 c 18446744073709551615\nfloat32 d 0.25\n"
    'float64 e -1e-3\nstring f "say \\"hi\\", or \'no\'"\nint32[] g [1, -2, 3]\n'
    "float64[2] h [0.5, 1]\nbool[2] i [true, false]\nstring<=4 j 'four'\n",
    "msg/Comments": '# One "quoted" line\n# another\\line\n\nfloat64 x # metres\n',
    "srv/Water": "uint8 ALL=0\nstring bed\n---\nbool done\nNumbers[] log\n",
    "srv/Nothing": "---\n",
    "action/Dig": "float32 depth 0.5\n---\nbool found\n---\nfloat32 depth\n",
}


def main() -> None:
    """Write the answers."""
    convert = import_module("rosidl_adapter").convert_to_idl
    answers = {}
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, text in DEFINITIONS.items():
            path = Path(f"{name}.{name.partition('/')[0]}")
            (root / path).parent.mkdir(exist_ok=True)
            (root / path).write_text(text)
            convert(root, PACKAGE, path, root / "out")
            answers[name] = (root / "out" / f"{name}.idl").read_text()
    ANSWERS.write_text(json.dumps(answers, indent=1) + "\n")


if __name__ == "__main__":
    main()
