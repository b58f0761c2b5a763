"""Dependencies point down only, the core is pure, and each module has its test file.

programs        broadcaster  listener  cli
    |
node/  hub/
    \\  /
protocol/  interfaces/  names  errors
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import fibws

PACKAGE = Path(fibws.__file__).parent
TESTS = Path(__file__).parent
IMPURE = {"asyncio", "websockets", "time", "random", "socket", "threading", "select", "signal"}
MASK = {"websockets.speedups.apply_mask", "websockets.utils.apply_mask"}

PURE_HUB = ["clock", "framing", "liveness", "outbox", "settings"]
BELOW = {
    "errors": set[str](),
    "names": {"errors"},
    "protocol": {"errors", "names", "protocol"},
    "interfaces": {"errors", "names", "interfaces"},
    "hub": {"errors", "names", "protocol", "interfaces", "hub", "__version__"},
    "node": {"errors", "names", "protocol", "interfaces", "node", "msg", "__version__"},
    "msg": {"errors", "interfaces", "msg"},
}
"""What each part of fibws may import of fibws."""

TESTED_ELSEWHERE = {
    "__main__.py": "programs/test_cli.py",
    "broadcaster.py": "programs/test_broadcaster.py",
    "cli/demo.py": "programs/test_demo.py",
    "cli/options.py": "programs/test_listener.py",
    "cli/program.py": "programs/test_listener.py",
    "interfaces/builtin.py": "interfaces/test_validators.py",
    "interfaces/definition.py": "interfaces/test_parser.py",
    "interfaces/faults.py": "interfaces/test_validators.py",
    "interfaces/leaves.py": "interfaces/test_validators.py",
    "interfaces/linker.py": "interfaces/test_catalogue.py",
    "interfaces/package.py": "interfaces/test_catalogue.py",
    "listener.py": "programs/test_listener.py",
    "msg/_finder.py": "msg/test_import.py",
}
"""Programs are tested as processes, and some modules only by way of the one they serve."""

UNTESTED = {"hub/clock.py"}
"""Modules of protocols, which mypy checks."""


def modules(*patterns: str) -> list[Path]:
    return sorted(path for pattern in patterns for path in PACKAGE.glob(pattern))


def path_id(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def imports(path: Path) -> set[str]:
    """The dotted names of all that a module imports, wherever in it."""
    found = set()
    for statement in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            assert statement.level == 0, f"{path} has a relative import"
            found |= {f"{statement.module}.{alias.name}" for alias in statement.names}
    return found


def parts(path: Path) -> set[str]:
    """The parts of fibws that a module imports from: ``hub`` for ``fibws.hub.graph.Graph``."""
    return {name.split(".")[1] for name in imports(path) if name.startswith("fibws.")}


PURE = [
    *modules("errors.py", "names.py", "protocol/*.py", "interfaces/*.py"),
    *modules("hub/graph/*.py", "hub/session/*.py", "hub/rosapi/*.py"),
    *(PACKAGE / "hub" / f"{name}.py" for name in PURE_HUB),
]


@pytest.mark.parametrize("path", PURE, ids=path_id)
def test_the_core_knows_no_sockets_tasks_or_clocks(path: Path) -> None:
    allowed = MASK if path_id(path) == "hub/framing.py" else set()
    impure = {name for name in imports(path) - allowed if name.partition(".")[0] in IMPURE}
    assert not impure


@pytest.mark.parametrize(
    "path",
    modules("errors.py", "names.py", *(f"{part}/**/*.py" for part in BELOW)),
    ids=path_id,
)
def test_dependencies_point_down(path: Path) -> None:
    part = path.relative_to(PACKAGE).with_suffix("").parts[0]
    assert parts(path) <= BELOW[part]


@pytest.mark.parametrize("path", modules("broadcaster.py", "listener.py"), ids=path_id)
def test_a_program_uses_only_public_names(path: Path) -> None:
    public = {*fibws.__all__, "cli", "msg"}
    assert parts(path) <= public


@pytest.mark.parametrize("path", PURE, ids=path_id)
def test_nothing_in_the_core_is_imported_by_a_private_name(path: Path) -> None:
    names = {name for name in imports(path) if name.startswith("fibws.")}
    private = {name for name in names if name.rpartition(".")[2].startswith("_")}
    assert not private - {"fibws.__version__"}


def test_every_module_has_its_test_file() -> None:
    missing = {
        path_id(path): f"tests/{mirror(path)}"
        for path in modules("*.py", "[!m]*/**/*.py", "msg/_*.py")
        if path.name != "__init__.py"
        and path_id(path) not in UNTESTED
        and not (TESTS / mirror(path)).exists()
    }
    assert not missing, "\n".join(f"{name} needs {test}" for name, test in missing.items())


def mirror(path: Path) -> str:
    """``hub/test_topic.py`` for ``hub/topic.py``."""
    beside = path.relative_to(PACKAGE).with_name(f"test_{path.stem.strip('_')}.py")
    return TESTED_ELSEWHERE.get(path_id(path), beside.as_posix())


@pytest.mark.parametrize("name", sorted({*TESTED_ELSEWHERE, *UNTESTED}))
def test_every_exception_is_still_one(name: str) -> None:
    assert (PACKAGE / name).is_file()
