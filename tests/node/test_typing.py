"""A type checker knows which messages a publisher takes: an ignored error that is none is one."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

PROGRAM = """
from typing import Any

from typing_extensions import assert_type

import fibws
from fibws.msg.std_msgs import Int32, String


async def program(node: fibws.Node) -> None:
    numbers = await node.advertise("numbers", Int32)
    await numbers.publish(5)
    await numbers.publish(data=5)
    await numbers.publish(Int32(5))
    await numbers.publish()
    await numbers.publish(String("x"))  # type: ignore[call-overload]
    await numbers.publish(dat=5)  # type: ignore[call-overload]
    await numbers.publish("five")  # type: ignore[call-overload]
    await numbers.publish(5, 6)  # type: ignore[call-overload]
    await node.advertise("numbers", int)  # type: ignore[type-var]
    named = await node.advertise("numbers", "std_msgs/Int32")
    await named.publish(5, what="ever")
    kept: fibws.Publisher[Int32] = numbers
    await kept.publish(Int32(5))
    async for number in node.subscribe("numbers", Int32):
        assert_type(number, Int32)
"""


def test_a_publisher_takes_the_fields_of_its_messages(tmp_path: Path) -> None:
    script = tmp_path / "program.py"
    script.write_text(PROGRAM, "utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", str(script)], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
