"""The page reads serialized messages as the hub does, for every type that the hub knows."""

from __future__ import annotations

import json
import os
import random
import shutil
import subprocess
from base64 import b64encode
from math import inf, nan
from pathlib import Path
from typing import Any

import pytest

from fibws.hub.rosapi.typedefs import TypeDefs
from fibws.interfaces import Interfaces
from fibws.interfaces.builtin import FLOATS, INTEGERS, STRINGS, TIMES
from fibws.interfaces.definition import Field
from fibws.interfaces.serialization import Serializers

WEB = Path(__file__).parents[2] / "web"
STANDARD = Interfaces()
TYPES = [name for package in STANDARD.packages() for name in STANDARD.messages(package)]
EXACT = 2**53
"""Integers from here on are not exact as numbers in JavaScript."""
ODD = (inf, -inf, nan, -0.0)
"""Numbers that JSON does not have."""


class Values:
    """Makes up values, of which there are all kinds that a type has."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)

    def message(self, type_: str) -> dict[str, Any]:
        return {field.name: self._field(field) for field in STANDARD.message(type_).fields}

    def _field(self, field: Field) -> Any:
        if field.array is None:
            return self._element(field.type)
        count = self._random.randrange(3) if field.array.fixed is None else field.array.fixed
        if field.is_bytes:
            return b64encode(self._random.randbytes(count)).decode()
        return [self._element(field.type) for _ in range(count)]

    def _element(self, type_: str) -> Any:
        if type_ in INTEGERS:
            low, high = INTEGERS[type_]
            return self._random.randint(low, high)
        if type_ in FLOATS:
            return self._random.choice([self._random.randrange(-1000, 1000) / 8, *ODD])
        if type_ in STRINGS:
            return self._random.choice(["", "a", "übung", "x" * 9])
        if type_ == "bool":
            return self._random.random() < 0.5
        if type_ in TIMES:
            return {"secs": self._random.randrange(2**31), "nsecs": self._random.randrange(10**9)}
        return self.message(type_)


def _as_javascript(value: Any) -> Any:
    """Return a message in which integers are texts if JavaScript has no such number."""
    if isinstance(value, dict):
        return {key: _as_javascript(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_as_javascript(each) for each in value]
    is_large = isinstance(value, int) and abs(value) >= EXACT
    return str(value) if is_large else value


@pytest.mark.skipif(
    not (os.environ.get("CI") or (WEB / "node_modules").is_dir()) or shutil.which("npx") is None,
    reason="needs npm ci, in web/",
)
def test_page_reads_messages_of_every_type(tmp_path: Path) -> None:
    typedefs, serializers = TypeDefs(STANDARD), Serializers(STANDARD)
    cases = []
    for seed, type_ in enumerate(TYPES):
        data = serializers.of(type_).serialize(Values(seed).message(type_))
        cases.append(
            {
                "typedefs": json.loads(typedefs.message(type_))["typedefs"],
                "definition": STANDARD.full_text(type_),
                "serialized": b64encode(data).decode(),
                "values": _as_javascript(serializers.of(type_).deserialize(data)),
            }
        )
    module = tmp_path / "cases.mjs"
    module.write_text(f"export const cases = {json.dumps(cases)};")
    done = subprocess.run(
        ["npx", "--no-install", "vitest", "run", "src/messages/reader.test.ts"],
        cwd=WEB,
        env={**os.environ, "VITE_READER_CASES": str(module), "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"({len(TYPES) + 9} tests)" in done.stdout
