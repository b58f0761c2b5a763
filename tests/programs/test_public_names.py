"""What `import fibws` gives."""

from __future__ import annotations

import asyncio
import sys

import pytest
from running_programs import ROOT

import fibws


async def test_public_names_are_loaded_on_first_use() -> None:
    code = (
        "import sys, fibws; before = set(sys.modules); fibws.Node; "
        "print('websockets' in before, 'pydantic' in before, 'asyncio' in before, "
        "'websockets' in sys.modules)"
    )
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", code, stdout=asyncio.subprocess.PIPE, cwd=ROOT
    )
    out, _ = await process.communicate()
    assert out == b"False False False True\n"


def test_all_public_names_exist() -> None:
    for name in fibws.__all__:
        assert getattr(fibws, name) is not None
    assert set(fibws.__all__) <= set(dir(fibws))
    with pytest.raises(AttributeError, match="Master"):
        fibws.Master  # type: ignore[attr-defined]  # noqa: B018
