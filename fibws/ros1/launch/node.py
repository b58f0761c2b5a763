"""<node> and <test>: programs to be started, with what is theirs alone."""

from __future__ import annotations

from fibws import names
from fibws.errors import InvalidName
from fibws.ros1.launch.attributes import Attributes, applies
from fibws.ros1.launch.model import Launch, Node
from fibws.ros1.launch.parameter import read_param, read_rosparam, set_parameter
from fibws.ros1.launch.scope import Scope
from fibws.ros1.launch.tag import Tag
from fibws.suggestions import suggestion_or_known

NODE = (
    *("pkg", "type", "name", "args", "output", "respawn", "respawn_delay", "required", "ns"),
    *("cwd", "clear_params", "launch-prefix", "machine"),
)
TEST = (*NODE, "test-name", "time-limit", "retry")
NOT_OF_TESTS = ("respawn", "respawn_delay", "output")
INNER = ("param", "rosparam", "remap", "env")
ROS_HOME = "ROS_HOME"


def read_node(tag: Tag, scope: Scope, launch: Launch) -> Node:
    """Read a <node> or a <test>, whose parameters are set in ``launch``."""
    is_test = tag.name == "test"
    attributes = Attributes(tag, scope, TEST if is_test else NODE)
    name = _test_name(tag, attributes) if is_test else attributes.required("name")
    try:
        names.check_base(name)
    except InvalidName as error:
        raise attributes.fault("name", str(error)) from None
    around = scope.inner(namespace_of(tag, attributes))
    within = around.inner(name)
    within.private = {}
    if attributes.flag("clear_params", False):
        launch.cleared.append(within.namespace)
    own = scope.inner()
    for child in tag.children:
        _read_inner(tag, child, scope, own, within, launch)
    for key, value in {**scope.private, **within.private}.items():
        set_parameter(launch, tag, within.join(key), value)
    respawn, required = attributes.flag("respawn", False), attributes.flag("required", False)
    if respawn and required:
        raise tag.fault("<node> has both respawn and required: one that comes back never ends all")
    cwd = attributes.one_of("cwd", "node", ROS_HOME, ROS_HOME.lower())
    return Node(
        package=attributes.required("pkg").strip(),
        type=attributes.required("type").strip(),
        name=name,
        file=tag.file,
        line=tag.line,
        namespace=around.namespace,
        args=attributes.text("args", ""),
        screen=attributes.one_of("output", "screen", "log") == "screen",
        respawn=respawn,
        respawn_delay=attributes.number("respawn_delay", 0.0),
        required=required,
        cwd="node" if cwd == "node" else None,
        prefix=attributes.text("launch-prefix", ""),
        remaps=tuple(own.remaps.items()),
        environment=tuple(own.environment.items()),
        is_test=is_test,
    )


def namespace_of(tag: Tag, attributes: Attributes) -> str | None:
    """What a tag's ``ns`` says; None if it has none."""
    if "ns" not in tag.attributes:
        return None
    namespace = attributes.required("ns")
    try:
        # A global one that is / has no name in it to be checked.
        return namespace if not namespace.strip("/") else _checked(namespace)
    except InvalidName as error:
        raise attributes.fault("ns", str(error)) from None


def _checked(namespace: str) -> str:
    path = names.check_namespace("/".join(part for part in namespace.split("/") if part))
    return path if namespace.startswith("/") else path[1:]


def read_remap(tag: Tag, scope: Scope, into: Scope) -> None:
    """Read a <remap>."""
    attributes = Attributes(tag, scope, ("from", "to"))
    found = []
    for end in ("from", "to"):
        text = attributes.required(end).strip()
        first = "/" if text.startswith("/") else ""
        try:
            found.append(names.check(first + "/".join(part for part in text.split("/") if part)))
        except InvalidName as error:
            raise attributes.fault(end, str(error)) from None
    into.remap(*found)


def read_env(tag: Tag, scope: Scope, into: Scope) -> None:
    """Read an <env>."""
    attributes = Attributes(tag, scope, ("name", "value"))
    name, value = attributes.required("name"), attributes.text("value")
    if value is None:
        raise tag.fault("<env> has no value, which it must have")
    if "=" in name or "\0" in name + value:
        raise attributes.fault("name", f"{name!r} cannot name a variable")
    into.environment[name] = value


def _read_inner(
    tag: Tag, child: Tag, scope: Scope, own: Scope, within: Scope, launch: Launch
) -> None:
    if child.name not in INNER:
        hint = suggestion_or_known(child.name, INNER)
        raise child.fault(f"<{tag.name}> has no <{child.name}> in it{hint}")
    if not applies(child, scope):
        return
    match child.name:
        case "remap":
            read_remap(child, scope, own)
        case "env":
            read_env(child, scope, own)
        case "param":
            read_param(child, within, launch, in_node=True)
        case _:
            read_rosparam(child, within, launch)


def _test_name(tag: Tag, attributes: Attributes) -> str:
    for name in NOT_OF_TESTS:
        if name in tag.attributes:
            raise tag.fault(f"<test> has no attribute {name}, which is one of <node>")
    attributes.number("time-limit", 60.0)
    attributes.number("retry", 0.0)
    test = attributes.required("test-name")
    return attributes.text("name") or test
