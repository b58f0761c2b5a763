"""Rules for the tests themselves: they depend on no clock, and not on the order of other tests."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from patience import PATIENCE

FOLDER = Path(__file__).parent
EXEMPT = (
    "ros1/scripts/",  # programs as users of ROS write them
    "real_ros1/scripts/",
    "ros1/side_by_side.py",  # waits for programs of a real ROS
    "web/",  # a browser gives no event for each picture that it draws
)
GENERATORS = {"Random", "RandomState", "default_rng"}
STATE = {"getstate", "setstate", "get_state", "set_state", "seed"}
"""Functions by which a test sets the shared generator for itself."""
LOOPS = (ast.While, ast.For, ast.AsyncFor)


def modules(word: str, pattern: str = "*.py") -> Iterator[tuple[str, ast.Module]]:
    """Yield the modules of tests that contain a word."""
    for path in FOLDER.rglob(pattern):
        name = path.relative_to(FOLDER).as_posix()
        if name.startswith(EXEMPT) or "node_modules" in path.parts:
            continue
        text = path.read_text("utf-8")
        if word in text:
            yield name, ast.parse(text, name)


def calls(node: ast.AST, *, in_loops: bool = True) -> Iterator[tuple[list[str], ast.Call]]:
    """Yield all calls below a node, and the parts of the names of what is called."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Call) and isinstance(child.func, ast.Name | ast.Attribute):
            yield ast.unparse(child.func).split("."), child
        if in_loops or not isinstance(child, LOOPS):
            yield from calls(child, in_loops=in_loops)


def test_no_test_sleeps_for_a_fixed_time() -> None:
    """Polls and programs that pace themselves sleep in loops; all others wait for an event."""
    found = []
    for name, module in modules(".sleep("):
        for words, call in calls(module, in_loops=False):
            if words in (["asyncio", "sleep"], ["time", "sleep"]):
                seconds = call.args[0]
                # Longer than a test waits is for ever: something must interrupt it.
                if isinstance(seconds, ast.Constant) and 0 < float(seconds.value) < PATIENCE:  # type: ignore[arg-type]
                    found.append(f"{name}:{call.lineno}: {ast.unparse(call)}")
    assert not found, found


def test_no_tests_share_random_numbers() -> None:
    """A failure can be repeated only if a test's numbers do not depend on the tests before it."""
    found = []
    for name, module in modules("random", "test_*.py"):
        imported = {
            alias.name
            for statement in module.body
            if isinstance(statement, ast.Import)
            for alias in statement.names
        }
        for statement in module.body:
            is_shared = isinstance(statement, ast.Assign | ast.AnnAssign)
            for words, call in calls(statement):
                uses_module = words[-2:-1] == ["random"] and {"random", "numpy"} & imported
                if is_shared if words[-1] in GENERATORS else uses_module and words[-1] not in STATE:
                    found.append(f"{name}:{call.lineno}: {ast.unparse(call)}")
    assert not found, found


def test_patience_is_the_same_everywhere() -> None:
    found = [
        name
        for name, module in modules("PATIENCE = ")
        for statement in module.body
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "PATIENCE"
    ]
    assert found == ["patience.py"]
