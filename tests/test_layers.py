"""Dependencies point down only, and the core is pure.

programs        broadcaster  listener  action_server ...  cli/  tf/  ros1/  workspace/  launch/
    |
node/  hub/     with msg/  srv/  action/, the classes of messages, beside node/
    \\  /
protocol/
    |
interfaces/  names  errors  hint  xmltree  yamltext
"""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import fibws

PACKAGE = Path(fibws.__file__).parent
IMPURE = {"asyncio", "websockets", "time", "random", "socket", "threading", "select", "signal"}
MASK = {"websockets.speedups.apply_mask", "websockets.utils.apply_mask"}

PURE_LAUNCH = ["attributes", "evaluation", "listing", "model", "node", "parameter", "reader"]
PURE_LAUNCH += ["scope", "screen", "substitution", "tag", "value", "vocabulary", "world"]
PURE_TF = ["buffer", "history", "messages", "selection", "transform"]
CLASSES = {"msg", "srv", "action"}
BELOW = {
    "errors": set[str](),
    "names": {"errors"},
    "yamltext": set[str](),
    "hint": set[str](),
    "xmltree": {"errors"},
    "protocol": {"errors", "names", "interfaces", "protocol"},
    "interfaces": {"errors", "names", "interfaces"},
    "hub": {"errors", "names", "protocol", "interfaces", "hub", "__version__"},
    "node": {"errors", "names", "protocol", "interfaces", "node", *CLASSES, "__version__"},
    "msg": {"errors", "interfaces", "msg"},
    "srv": {"errors", "interfaces", "msg", "srv"},
    "action": {"errors", "interfaces", "msg", "action"},
    "tf": {"errors", "interfaces", *CLASSES, "tf"},
    "ros1": {*fibws.__all__, "errors", "names", "yamltext", "interfaces", *CLASSES, "ros1"}
    | {"__main__"},
    "ros1/python": {*fibws.__all__, "errors", "names", "yamltext", "interfaces", *CLASSES}
    | {"cli", "node", "ros1", "workspace"},
    "workspace": {"errors", "hint", "names", "xmltree", "interfaces", "workspace", "ros1"},
    "launch": {"errors", "hint", "names", "xmltree", "launch", "workspace", "ros1"},
}
"""The parts of fibws that each part may import; ros1/python is for scripts, above the others."""

BELOW_IN_HUB = {
    "graph": {"errors", "names", "interfaces", "hub.graph"},
    "delivery": {"protocol.frame_queue", "hub.delivery"},
    "websocket": {"errors", "names", "protocol.websocket", "hub.delivery", "hub.websocket"}
    | {"hub.settings", "hub.log_text"},
    "rosbridge": {"errors", "names", "protocol", "hub.graph", "hub.delivery", "hub.rosbridge"}
    | {"hub.settings", "hub.log_text", "hub.websocket.endpoint"},
    "rosapi": {"errors", "names", "protocol", "interfaces", "hub.graph", "hub.delivery"}
    | {"hub.rosapi", "hub.log_text"},
}
"""The modules of fibws that each layer of the hub may import: the graph knows no frames and no
operations, delivery knows bytes, websocket knows endpoints but no operations."""

TOOLS = {"cli", "errors", "names", "yamltext", "node", "interfaces", "launch", "ros1", "workspace"}
TOOLS |= {"__version__", "hint", "protocol"}
"""What command-line tools may import of fibws: of `node` and `protocol`, only `LIGHT`; slow modules
such as `interfaces` in functions only."""
LIGHT = {"node": "fibws.node.address", "protocol": "fibws.protocol.serialized"}
SLOW = {"asyncio", "pydantic", "pydantic_core", "yaml", "rich", "ssl", "cbor2", "fibws.interfaces"}
NO_TOOLS = {"cli/demo.py", "cli/launch/run.py", "cli/options.py", "cli/program.py"}

PROGRAMS = ["action_client", "action_server", "add_two_ints_client", "add_two_ints_server"]
PROGRAMS += ["broadcaster", "listener", "static_transform_publisher", "tf2_web_republisher"]
"""Modules to be read as well as to be run."""


def modules(*patterns: str) -> list[Path]:
    return sorted({path for pattern in patterns for path in PACKAGE.glob(pattern)})


def path_id(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def imports(path: Path, *, inside: bool = True) -> set[str]:
    """The dotted names of all that a module imports, in its functions or not ``inside`` them."""
    found = set()
    module = ast.parse(path.read_text("utf-8"))
    for statement in ast.walk(module) if inside else module.body:
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
    *modules("errors.py", "names.py", "yamltext.py", "protocol/*.py", "interfaces/*.py"),
    *modules("hub/graph/*.py", "hub/delivery/*.py", "hub/rosbridge/*.py", "hub/rosapi/*.py"),
    *modules("hub/settings.py", "hub/log_text.py", "hub/websocket/keepalive.py"),
    *(PACKAGE / "tf" / f"{name}.py" for name in PURE_TF),
    *(PACKAGE / "launch" / f"{name}.py" for name in PURE_LAUNCH),
]


@pytest.mark.parametrize("path", PURE, ids=path_id)
def test_the_core_knows_no_sockets_tasks_or_clocks(path: Path) -> None:
    allowed = MASK if path_id(path) == "protocol/websocket.py" else set()
    impure = {name for name in imports(path) - allowed if name.partition(".")[0] in IMPURE}
    assert not impure


@pytest.mark.parametrize(
    "path",
    modules("errors.py", "names.py", "yamltext.py", *(f"{part}/**/*.py" for part in BELOW)),
    ids=path_id,
)
def test_dependencies_point_down(path: Path) -> None:
    folders = path.relative_to(PACKAGE).with_suffix("").parts
    part = "ros1/python" if folders[:2] == ("ros1", "python") else folders[0]
    assert parts(path) <= BELOW[part]


@pytest.mark.parametrize("layer", BELOW_IN_HUB)
def test_layers_of_the_hub_do_not_look_up(layer: str) -> None:
    found = {
        name.removeprefix("fibws.")
        for path in modules(f"hub/{layer}/*.py")
        for name in imports(path)
        if name.startswith("fibws.")
    }
    allowed = BELOW_IN_HUB[layer]
    assert not {name for name in found if not any(_is_in(name, each) for each in allowed)}


@pytest.mark.parametrize("path", modules(*(f"{name}.py" for name in PROGRAMS)), ids=path_id)
def test_a_program_uses_only_public_names(path: Path) -> None:
    public = {*fibws.__all__, *CLASSES, "cli", "tf"}
    assert parts(path) <= public


@pytest.mark.parametrize(
    "path",
    [path for path in modules("cli/**/*.py") if path_id(path) not in NO_TOOLS],
    ids=path_id,
)
def test_a_tool_loads_at_once(path: Path) -> None:
    assert parts(path) <= TOOLS
    for part, module in LIGHT.items():
        used = {name for name in imports(path) if _is_in(name, f"fibws.{part}")}
        assert all(_is_in(name, module) for name in used)
    slow = {
        name for name in imports(path, inside=False) if any(_is_in(name, each) for each in SLOW)
    }
    assert not slow


def _is_in(name: str, package: str) -> bool:
    return f"{name}.".startswith(f"{package}.")


@pytest.mark.parametrize("path", PURE, ids=path_id)
def test_nothing_in_the_core_is_imported_by_a_private_name(path: Path) -> None:
    names = {name for name in imports(path) if name.startswith("fibws.")}
    private = {name for name in names if name.rpartition(".")[2].startswith("_")}
    assert not private - {"fibws.__version__"}
