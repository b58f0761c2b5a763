"""The memory that a process may use, by its control groups."""

from __future__ import annotations

from pathlib import Path

import pytest

from fibws.hub.memory.machine import available_memory

MACHINE = available_memory(Path("/no/such/folder"))
MIB = 2**20


def system(root: Path, groups: str, **limits: str) -> Path:
    """Write the files that the kernel shows; limits by path, in which ``__`` stands for ``/``."""
    (root / "proc/self").mkdir(parents=True)
    (root / "proc/self/cgroup").write_text(groups)
    for path, limit in limits.items():
        file = root / "sys/fs/cgroup" / path.replace("__", "/").replace("max", "memory.max")
        file = file.with_name(file.name.replace("limit", "memory.limit_in_bytes"))
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{limit}\n")
    return root


def test_machine_has_some_memory() -> None:
    assert MACHINE >= 64 * MIB


@pytest.mark.parametrize(
    ("groups", "limits", "expected"),
    [
        ("0::/\n", {"max": str(50 * MIB)}, 50 * MIB),
        ("0::/a/b\n", {"a__b__max": "max", "a__max": str(60 * MIB)}, 60 * MIB),
        ("0::/a/b\n", {"a__b__max": str(40 * MIB), "a__max": str(60 * MIB)}, 40 * MIB),
        ("0::/a\n", {"a__max": "max"}, MACHINE),
        ("0::/../../a\n", {"max": str(50 * MIB)}, 50 * MIB),
        ("0::/a\n", {"a__max": str(2**62)}, MACHINE),
        ("5:cpu:/x\n4:cpuset,memory:/docker/f\n", {"memory__limit": str(30 * MIB)}, 30 * MIB),
        ("4:memory:/u\n", {"memory__u__limit": str(20 * MIB)}, 20 * MIB),
        ("4:cpu:/u\n", {"memory__u__limit": str(20 * MIB)}, MACHINE),
        ("nonsense\n", {}, MACHINE),
    ],
)
def test_least_limit_of_the_groups_counts(
    tmp_path: Path, groups: str, limits: dict[str, str], expected: int
) -> None:
    assert available_memory(system(tmp_path, groups, **limits)) == expected
