"""Dependencies point down only, the core is pure, and each module has its test file.

programs        broadcaster  listener  action_server ...  cli/  tf/  ros1/  workspace/  launch/
    |
node/  hub/     with msg/  srv/  action/, the classes of messages, beside node/
    \\  /
protocol/  interfaces/  names  errors  hint  xmltree  yamltext
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

PURE_HUB = ["budget", "clock", "frames", "liveness", "logtext", "outbox", "settings", "splitter"]
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
    "protocol": {"errors", "names", "protocol"},
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
"""What each part of fibws may import of fibws; ros1/python is for scripts, and above the others."""

TOOLS = {"cli", "errors", "names", "yamltext", "node", "interfaces", "launch", "ros1", "workspace"}
TOOLS |= {"__version__", "hint"}
"""What the tools of the command line may import of fibws: of `node`, no more than `node.address`;
`interfaces` in functions alone, as whatever else takes its time to be loaded."""
SLOW = {"asyncio", "pydantic", "pydantic_core", "yaml", "rich", "ssl", "cbor2", "fibws.interfaces"}
NO_TOOLS = {"cli/demo.py", "cli/launch/run.py", "cli/options.py", "cli/program.py"}

PROGRAMS = ["action_client", "action_server", "add_two_ints_client", "add_two_ints_server"]
PROGRAMS += ["broadcaster", "listener", "static_transform_publisher", "tf2_web_republisher"]
"""Modules to be read as well as to be run."""

TESTED_ELSEWHERE = {
    "__main__.py": "programs/test_cli.py",
    "cli/demo.py": "programs/test_demo.py",
    "cli/doctor/finding.py": "programs/cli/test_doctor.py",
    "cli/launch/sources.py": "programs/cli/launch/test_listing.py",
    "cli/launch/parameters.py": "programs/cli/launch/test_run.py",
    "cli/options.py": "programs/test_listener.py",
    "cli/program.py": "programs/test_listener.py",
    "cli/top/keyboard.py": "programs/cli/test_top.py",
    "cli/top/screen.py": "programs/cli/test_top.py",
    "cli/types/commands.py": "programs/cli/test_msg.py",
    "cli/types/installed.py": "programs/cli/test_msg.py",
    "cli/types/shape.py": "programs/cli/test_msg.py",
    "interfaces/binary.py": "interfaces/test_serialization.py",
    "interfaces/builtin.py": "interfaces/test_validators.py",
    "interfaces/definition.py": "interfaces/test_parser.py",
    "interfaces/faults.py": "interfaces/test_validators.py",
    "interfaces/layout.py": "interfaces/test_serialization.py",
    "interfaces/leaves.py": "interfaces/test_validators.py",
    "interfaces/linker.py": "interfaces/test_catalogue.py",
    "interfaces/package.py": "interfaces/test_catalogue.py",
    "interfaces/source.py": "interfaces/test_generator.py",
    "launch/attributes.py": "launch/test_node.py",
    "launch/hub.py": "programs/cli/launch/test_run.py",
    "launch/model.py": "launch/test_node.py",
    "launch/scope.py": "launch/test_substitution.py",
    "msg/_finder.py": "msg/test_import.py",
    "node/advertisement.py": "node/test_outbox.py",
    "node/part.py": "node/test_session.py",
    "node/rosapi.py": "node/test_params.py",
    "ros1/__main__.py": "programs/cli/test_door.py",
    "ros1/advice.py": "ros1/test_finder.py",
    "ros1/doors.py": "programs/cli/test_door.py",
    "ros1/folders.py": "ros1/test_finder.py",
    "ros1/python/actionlib/exceptions.py": "ros1/actionlib/test_action_spec.py",
    "ros1/python/genpy/codec.py": "ros1/genpy/test_side_by_side.py",
    "ros1/python/genpy/errors.py": "ros1/genpy/test_message.py",
    "ros1/python/genpy/lookup.py": "ros1/genpy/test_classes.py",
    "ros1/python/genpy/member.py": "ros1/genpy/test_message.py",
    "ros1/python/message_filters/stamp.py": "ros1/message_filters/test_cache.py",
    "ros1/python/roslib/launcher.py": "ros1/roslib/test_message.py",
    "ros1/python/roslib/rostime.py": "ros1/roslib/test_message.py",
    "ros1/python/rospkg/common.py": "ros1/rospkg/test_rospack.py",
    "ros1/python/rospkg/manifest.py": "ros1/rospkg/test_rospack.py",
    "ros1/python/rospy/exceptions.py": "ros1/rospy/test_core.py",
    "ros1/python/rospy/impl/tcpros.py": "ros1/rospy/impl/test_tcpros_service.py",
    "ros1/python/rospy/impl/tcpros_base.py": "ros1/rospy/impl/test_tcpros_service.py",
    "ros1/python/sitecustomize.py": "ros1/test_finder.py",
    "ros1/tutorials/listener.py": "ros1/test_stand_ins.py",
    "ros1/tutorials/talker.py": "ros1/test_stand_ins.py",
    "rospy.py": "programs/test_rospy.py",
    "workspace/cmake/condition.py": "workspace/cmake/test_script.py",
    "workspace/elsewhere.py": "workspace/test_check.py",
    "workspace/recipe.py": "workspace/test_reader.py",
    "workspace/source.py": "workspace/test_build.py",
    "workspace/templates.py": "workspace/test_skeleton.py",
    "workspace/cmake/vocabulary.py": "workspace/test_reader.py",
}
"""Programs are tested as processes, and some modules only by way of the one they serve."""

UNTESTED = {"hub/clock.py", "launch/world.py"}
"""Modules of protocols, which mypy checks."""


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
    *modules("hub/graph/*.py", "hub/session/*.py", "hub/rosapi/*.py"),
    *(PACKAGE / "hub" / f"{name}.py" for name in PURE_HUB),
    *(PACKAGE / "tf" / f"{name}.py" for name in PURE_TF),
    *(PACKAGE / "launch" / f"{name}.py" for name in PURE_LAUNCH),
]


@pytest.mark.parametrize("path", PURE, ids=path_id)
def test_the_core_knows_no_sockets_tasks_or_clocks(path: Path) -> None:
    allowed = MASK if path_id(path) == "hub/splitter.py" else set()
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
    assert not {name for name in imports(path) if name.startswith("fibws.node.")} - {
        "fibws.node.address"
    }
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


def test_every_module_has_its_test_file() -> None:
    missing = {
        path_id(path): f"tests/{mirror(path)}"
        for path in modules("**/*.py")
        if path.name != "__init__.py"
        and path_id(path) not in UNTESTED
        and (path.parent.name not in CLASSES or path.stem.startswith("_"))
        and not (TESTS / mirror(path)).exists()
    }
    assert not missing, "\n".join(f"{name} needs {test}" for name, test in missing.items())


def mirror(path: Path) -> str:
    """``hub/test_gate.py`` for ``hub/gate.py``."""
    if path.parent == PACKAGE and path.stem in PROGRAMS:
        return f"programs/test_{path.stem}.py"
    beside = path.relative_to(PACKAGE).with_name(f"test_{path.stem.strip('_')}.py")
    if beside.parts[:2] == ("ros1", "python"):
        beside = Path("ros1", *beside.parts[2:])
    if beside.parts[0] == "cli":
        beside = "programs" / beside
    return TESTED_ELSEWHERE.get(path_id(path), beside.as_posix())


@pytest.mark.parametrize("name", sorted({*TESTED_ELSEWHERE, *UNTESTED}))
def test_every_exception_is_still_one(name: str) -> None:
    assert (PACKAGE / name).is_file()
