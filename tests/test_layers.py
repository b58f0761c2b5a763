"""Dependencies point down only, and the pure layers use no sockets, tasks or clocks.

docs/architecture.md draws the layers.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import fibws

PACKAGE = Path(fibws.__file__).parent
IMPURE = {"asyncio", "websockets", "time", "random", "socket", "threading", "select", "signal"}
MASK = {"websockets.speedups.apply_mask", "websockets.utils.apply_mask"}

CLASSES = {"msg", "srv", "action"}
NODE = {*fibws.__all__} - {"Hub", "Settings", "hub", "tf"} - CLASSES
"""The public names of the node library."""
LOWEST = {"errors", "files", "names", "suggestions", "hub_address", "tls", "credentials", "access"}
BELOW = {
    "errors": {"command_names", "hub_advice"},
    "names": {"errors"},
    "suggestions": set[str](),
    "public_classes": {"suggestions"},
    "files": set[str](),
    "hub_address": {"errors", "hub_advice"},
    "hub_advice": {"command_names"},
    "tls": {"errors"},
    "credentials": {"errors", "hub_address", "protocol"},
    "client_handshake": {"hub_address"},
    "command_names": set[str](),
    "definition_folders": set[str](),
    "origins": set[str](),
    "processes": set[str](),
    "exit_signals": set[str](),
    "access": {"errors", "files", "suggestions"},
    "bag_recorder": {"bags", "command_names", "errors", "exit_signals", "files"},
    "interfaces": {"definition_folders", "errors", "files", "names", "suggestions"},
    "protocol": {"errors", "names", "interfaces"},
    "bags": {"errors", "files", "interfaces"},
    "values": {*LOWEST, "interfaces", "definition_folders"},
    "hub": {"errors", "files", "names", "access", "protocol", "interfaces", "__version__"}
    | {"hub_address", "credentials", "tls", "bag_recorder", "origins", "client_handshake"}
    | {"exit_signals", "suggestions", "values", "public_classes"},
    "client": {*LOWEST, "protocol", "values"},
    "msg": {"errors", "interfaces", "suggestions"},
    "srv": {"errors", "interfaces", "msg"},
    "action": {"errors", "interfaces", "msg"},
    "node": {
        "errors",
        "public_classes",
        "names",
        "hub_address",
        "tls",
        "credentials",
        "protocol",
        "interfaces",
    }
    | {*CLASSES}
    | {"__version__", "client_handshake", "exit_signals", "suggestions"},
    "tf": {"public_classes", *NODE, "errors", "interfaces", *CLASSES},
    "ros1": {*NODE, *LOWEST, "bags", "values", "client", "node", "interfaces", *CLASSES}
    | {"command_names", "definition_folders", "exit_signals", "processes", "tf"},
    "testing": {*NODE, "hub"},
    "programs": {*NODE, *CLASSES, "errors", "hub_address", "cli", "client", "hub", "origins"}
    | {"suggestions", "tf", "values"},
    "broadcaster": {"programs"},
    "listener": {"programs"},
    "examples": {*NODE, *CLASSES, "cli"},
    "cli": {*NODE, *LOWEST, "bags", "values", "client", "interfaces", "node", "msg", "ros1"}
    | {"command_names", "definition_folders", "processes", "protocol", "__version__", "__main__"}
    | {"bag_recorder", "exit_signals", "srv"},
}
"""The parts of fibws that each part may import, besides itself."""

BELOW_IN_HUB = {
    "graph": {"errors", "names", "interfaces", "access.rights", "hub.graph"},
    "delivery": {"protocol.deflate", "protocol.frame_queue", "hub.delivery"},
    "websocket": {
        "errors",
        "files",
        "names",
        "origins",
        "access",
        "protocol.deflate",
        "protocol.websocket",
        "hub.delivery",
        "hub.http",
        "hub.tls",
        "hub.websocket",
    }
    | {"hub.settings", "hub.log", "hub.access.authentication", "hub.memory"}
    | {"tls"},
    "http": {"errors", "access", "files", "names", "origins", "hub.access", "hub.http", "hub.log"}
    | {"hub.graph", "hub.memory", "hub.package_folders", "hub.recording", "hub.settings"}
    | {"hub.websocket.deflate_extension", "hub.websocket.endpoint"}
    | {"hub.worker_threads", "protocol.websocket"},
    "tls": {"errors", "files", "tls", "hub.access", "hub.log", "hub.tls"},
    "log": {"errors", "hub.log"},
    "memory": {"hub.delivery", "hub.memory", "protocol.websocket"},
    "monitoring": {"errors", "access", "hub.access", "hub.log", "hub.graph", "hub.settings"}
    | {"hub.http", "hub.memory"}
    | {"hub.delivery", "hub.monitoring", "hub.websocket", "__version__"},
    "access": {"errors", "access", "hub.access", "hub.graph", "hub.settings", "hub.log"}
    | {"protocol.websocket", "origins"},
    "rosbridge": {
        "errors",
        "names",
        "access.rights",
        "protocol",
        "hub.graph",
        "hub.delivery",
        "hub.rosbridge",
    }
    | {"hub.settings", "hub.log", "hub.node_session", "hub.websocket.endpoint"}
    | {"interfaces.serialized_values"},
    "foxglove": {"errors", "access.rights", "interfaces", "protocol", "hub.foxglove", "hub.graph"}
    | {"hub.log", "hub.memory", "hub.delivery", "hub.settings"}
    | {"hub.node_session", "hub.websocket.endpoint"},
    "foreign": {"errors", "hub.graph", "hub.foreign", "hub.delivery.clock", "hub.log"},
    "ros1": {"errors", "files", "names", "access.rights", "interfaces", "hub.graph", "hub.ros1"}
    | {"hub.foreign", "origins", "hub.memory", "hub.kept_file"}
    | {"hub.log", "hub.delivery.clock", "hub.package_folders", "hub.settings"},
    "federation": {"errors", "names", "access.rights", "interfaces"}
    | {"protocol.refusals", "protocol.websocket"}
    | {"client_handshake", "credentials", "hub_address", "tls"}
    | {"hub.federation", "hub.foreign", "hub.graph", "hub.log"}
    | {"hub.delivery.clock", "hub.log", "hub.settings", "hub.websocket.endpoint"}
    | {"hub.memory", "hub.zenoh_session"},
    "ros2": {"errors", "access.rights", "interfaces", "hub.graph", "hub.ros2", "hub.settings"}
    | {"hub.delivery.clock", "hub.foreign", "hub.log", "hub.zenoh_session"},
    "rosapi": {"errors", "names", "protocol", "interfaces", "access.rights", "hub.graph"}
    | {"hub.delivery", "hub.rosapi", "hub.log"},
}
"""The modules of fibws that each layer of the hub may import: the graph knows no frames and no
operations, delivery knows bytes, websocket knows endpoints but no operations."""

ONLY = {
    "client": {"protocol": {"serialized", "goals", "refusals", "websocket"}},
    "cli": {"protocol": {"levels", "goals"}, "node": {"program"}},
    "ros1/launch": {"node": set[str]()},
    "ros1/workspace": {"node": set[str]()},
}
"""The only modules of other parts that a part may import: those that load at once."""

QUICK = ["tls.py", "access/*.py", "bags/*.py", "client/**/*.py", "values/**/*.py", "cli/**/*.py"]
SLOW = {
    "asyncio",
    "pydantic",
    "pydantic_core",
    "yaml",
    "rich",
    "ssl",
    "cbor2",
    "tomlkit",
    "fibws.interfaces",
}
NODES = {"cli/node_program.py"}
NODES |= {"cli/keyboard.py", *(f"cli/bag/{name}.py" for name in ("play", "playback", "record"))}
"""Commands that are nodes themselves, or run some."""


PUBLIC = "the graph's, and the public class of the node library for the other end of the wire"
SAME_NAMES = {
    **dict.fromkeys(["Action", "ActionClient", "ActionServer", "Graph", "Service"], PUBLIC),
    "ServiceServer": PUBLIC,
    "Connection": "a WebSocket's, and rosbag's word for a topic in a bag",
    "Peers": "of the node library, and the operation, which are all called by their ``op``",
}
"""Names of several classes, each with the reason."""


def modules(*patterns: str) -> list[Path]:
    return sorted({path for pattern in patterns for path in PACKAGE.glob(pattern)})


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


@cache
def imports(path: Path, *, inside: bool = True) -> set[str]:
    """Return the dotted names that a module imports, with those in functions if ``inside``."""
    found = set()
    module = parsed(path)
    for statement in ast.walk(module) if inside else module.body:
        if isinstance(statement, ast.Import):
            found |= {alias.name for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            assert statement.level == 0, f"{path} has a relative import"
            found |= {f"{statement.module}.{alias.name}" for alias in statement.names}
    return found


def own_imports(path: Path) -> set[str]:
    """Return the names below ``fibws`` that a module imports: ``hub.graph.graph.Graph``."""
    names = imports(path)
    return {name.removeprefix("fibws.") for name in names if name.startswith("fibws.")}


def is_in(name: str, package: str) -> bool:
    return f"{name}.".startswith(f"{package}.")


PURE = modules(
    *("errors.py", "names.py", "suggestions.py", "command_names.py"),
    *("hub_address.py", "hub_advice.py"),
    "origins.py",
    *("access/*.py", "bags/*.py", "protocol/*.py", "interfaces/*.py"),
    *("hub/graph/*.py", "hub/delivery/*.py", "hub/rosbridge/*.py", "hub/rosapi/*.py"),
    "hub/foxglove/*.py",
    *(f"ros1/launch/{name}.py" for name in ("model", "parameters", "reader", "scope")),
    *("ros1/errors.py", "ros1/launch/xml_element.py"),
    *(
        "hub/errors.py",
        "hub/settings.py",
        "hub/log/text.py",
        "hub/log/audit.py",
        "hub/websocket/keepalive.py",
    ),
    "hub/websocket/quotas.py",
    *(f"hub/ros2/{name}.py" for name in ("key_layout", "type_hashes", "types")),
    *(
        f"tf/{name}.py"
        for name in (
            *("buffer", "errors", "history", "listing", "messages", "selection"),
            *("serialized", "transform"),
        )
    ),
    *(f"programs/demo_robot/{name}.py" for name in ("body", "world")),
    *(f"programs/turtlesim/{name}.py" for name in ("canvas", "field")),
)


def test_pure_layers_use_no_sockets_tasks_or_clocks() -> None:
    for path in PURE:
        allowed = MASK if name_of(path) == "protocol/websocket.py" else set()
        impure = {name for name in imports(path) - allowed if name.partition(".")[0] in IMPURE}
        assert not impure, f"{name_of(path)} imports {impure}"


def test_nothing_in_the_pure_layers_is_imported_by_a_private_name() -> None:
    for path in PURE:
        names = own_imports(path) - {"__version__"}
        private = {name for name in names if name.rpartition(".")[2].startswith("_")}
        assert not private, f"{name_of(path)} imports {private}"


@pytest.mark.parametrize("part", BELOW)
def test_dependencies_point_down(part: str) -> None:
    for path in modules(f"{part}.py", f"{part}/**/*.py"):
        for name in own_imports(path):
            top = name.partition(".")[0]
            assert top in BELOW[part] | {part}, f"{name_of(path)} imports fibws.{name}"


def test_each_part_has_its_layer() -> None:
    parts = {path.stem for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    parts |= {path.stem for path in modules("*.py")}
    assert parts - {"__init__", "__main__", "_version", "rospy"} == set(BELOW)


def test_each_part_and_room_of_the_hub_is_in_the_drawing() -> None:
    text = (PACKAGE.parent / "docs" / "architecture.md").read_text("utf-8")
    layers, _, hub = text.partition("## Inside the hub")
    layers = layers.partition("## The layers")[2]
    assert not [each for each in BELOW if not re.search(rf"\b{each}(/|\.py\b)", layers)]
    hub = hub.partition("## The way of one message")[0]
    rooms = {path.name for path in (PACKAGE / "hub").iterdir() if (path / "__init__.py").exists()}
    assert not [each for each in rooms if not re.search(rf"\b{each}/", hub)]


@pytest.mark.parametrize("layer", BELOW_IN_HUB)
def test_layers_of_the_hub_do_not_look_up(layer: str) -> None:
    for path in modules(f"hub/{layer}/*.py"):
        for name in own_imports(path):
            allowed = any(is_in(name, each) for each in BELOW_IN_HUB[layer] | {"hub.errors"})
            assert allowed, f"{name_of(path)} imports fibws.{name}"


def test_hub_reads_serialized_values_by_types_alone() -> None:
    """There alone is the guard against values that keep the hub busy."""
    readers = {
        name_of(path)
        for path in modules("hub/**/*.py")
        for node in ast.walk(parsed(path))
        if isinstance(node, ast.Attribute) and node.attr == "deserialize"
    }
    of_topics = {"hub/graph/publication.py", "hub/graph/topic.py"}  # CheckedType.deserialize
    assert readers == {"hub/graph/types.py", *of_topics}


@pytest.mark.parametrize("part", ONLY)
def test_tools_use_only_the_quick_modules_of_other_parts(part: str) -> None:
    for path in modules(f"{part}/**/*.py"):
        for other, allowed in ONLY[part].items():
            used = {name.split(".")[1] for name in own_imports(path) if is_in(name, other)}
            assert used <= allowed, f"{name_of(path)} imports {used - allowed} of {other}"


def test_tool_loads_at_once() -> None:
    for path in modules(*QUICK):
        if name_of(path) not in NODES:
            slow = {
                name
                for name in imports(path, inside=False)
                if any(is_in(name, each) for each in SLOW)
            }
            assert not slow, f"{name_of(path)} imports {slow}"
            if not name_of(path).startswith("values/"):
                assert "fibws.interfaces" not in imports(path, inside=False)


def test_library_knows_no_command_line() -> None:
    for path in modules("client/**/*.py", "values/**/*.py", "node/**/*.py", "ros1/**/*.py"):
        found = {name for name in imports(path) if name.partition(".")[0] in ("click", "rich")}
        assert not found, f"{name_of(path)} imports {found}"


def test_one_name_is_one_class() -> None:
    """ROS 1's modules have ROS's names, and generated classes those of their types."""
    found: dict[str, list[str]] = {}
    for path in modules("**/*.py"):
        name = name_of(path)
        if name.startswith(("ros1/python/", "ros1/fallback/", "msg/", "srv/", "action/")):
            continue
        for node in ast.walk(parsed(path)):
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(name)
    several = {name: places for name, places in found.items() if len(places) > 1}
    assert several.keys() == SAME_NAMES.keys(), several
