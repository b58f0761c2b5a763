"""Robot models in URDF: their links, and the joints between these.

Source: http://wiki.ros.org/urdf/XML.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, inf, isfinite, sin

from fibws.ros1 import xml_tree
from fibws.ros1.errors import UrdfError
from fibws.tf.transform import Transform, Vector, of_yaw_pitch_roll

ROTATING = ("revolute", "continuous")
MOVING = (*ROTATING, "prismatic")
"""The types of joints that have one position; others are treated as fixed, as in ROS."""
TYPES = (*MOVING, "fixed", "floating", "planar")
MOST_LINKS = 10_000


@dataclass
class _UrdfElement(xml_tree.Element):
    def fault(self, text: str) -> UrdfError:
        return UrdfError(f"{self.file}:{self.line}: {text}")

    def required(self, name: str) -> str:
        """Return an attribute that must be there."""
        if not self.attributes.get(name):
            raise self.fault(f"<{self.name}> requires attribute {name}")
        return self.attributes[name]

    def number(self, name: str, default: float) -> float:
        """Return a finite number."""
        return self.numbers(name, 1, (default,))[0]

    def numbers(self, name: str, count: int, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return some finite numbers."""
        text = self.attributes.get(name)
        if text is None:
            return default
        try:
            found = tuple(map(float, text.split()))
        except ValueError:
            found = ()
        if len(found) != count or not all(map(isfinite, found)):
            raise self.fault(f"{name} must be {count} finite numbers, got {text[:100]!r}")
        return found


@dataclass(frozen=True)
class Mimic:
    """How a joint follows another one: position = multiplier * other + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint between two links.

    Attributes:
        name: its name.
        type: ``revolute``, ``continuous``, ``prismatic``, ``fixed``, ``floating`` or ``planar``.
        parent: the link nearer to the root.
        child: the other link.
        origin: the child in the parent at position 0.
        axis: of length 1, in the child's frame.
        lower: the least position, in radians or metres; minus infinity without a limit.
        upper: the greatest position.
        mimic: the joint that it follows.
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Transform
    axis: Vector
    lower: float
    upper: float
    mimic: Mimic | None

    @property
    def moves(self) -> bool:
        """Whether it has a position."""
        return self.type in MOVING

    def at(self, position: float) -> Transform:
        """Return the child in the parent at a position in radians or metres."""
        x, y, z = self.axis
        if self.type in ROTATING:
            half = sin(position / 2)
            rotation = (x * half, y * half, z * half, cos(position / 2))
            return self.origin @ Transform(rotation=rotation)
        if self.type == "prismatic":
            return self.origin @ Transform((x * position, y * position, z * position))
        return self.origin


@dataclass(frozen=True)
class RobotModel:
    """A robot.

    Attributes:
        name: its name.
        root: the link that all others hang on.
        links: the names of its links.
        joints: its joints by name, in the order of the document.
    """

    name: str
    root: str
    links: tuple[str, ...]
    joints: dict[str, Joint]

    def positions(self, known: dict[str, float]) -> dict[str, float]:
        """Return the positions of joints, with those that follow them.

        Args:
            known: positions by the joints' names; unknown joints are left out.
        """
        found = {name: each for name, each in known.items() if name in self.joints}
        for name, joint in self.joints.items():
            mimic = joint.mimic
            if mimic is not None and mimic.joint in known and name not in known:
                found[name] = mimic.multiplier * known[mimic.joint] + mimic.offset
        return {name: each for name, each in found.items() if self.joints[name].moves}


def read_urdf(text: str, file: str = "robot_description") -> RobotModel:
    """Return the robot that a document describes.

    Args:
        text: the XML.
        file: its name in errors.

    Raises:
        UrdfError: it is invalid, or its links are not one tree.
    """
    root = xml_tree.read(text.encode(), file, _UrdfElement)
    if root.name != "robot":
        raise root.fault(f"expected <robot>, got <{root.name}>")
    links = _links(root)
    joints, parents = _joints(root, links)
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        found = ", ".join(roots[:5]) or "none, since the joints are a loop"
        raise root.fault(f"expected one link without a parent, got {found}")
    if len(_reached(roots[0], parents)) < len(links):
        raise root.fault("some joints are a loop, which is not joined to the root")
    return RobotModel(root.attributes.get("name", ""), roots[0], tuple(links), joints)


def _joints(root: _UrdfElement, links: dict[str, None]) -> tuple[dict[str, Joint], dict[str, str]]:
    """Return the joints by their names, and the parent of each link that has one."""
    joints: dict[str, Joint] = {}
    parents: dict[str, str] = {}
    for element in root.all("joint"):
        joint = _joint(element)
        if joint.name in joints:
            raise element.fault(f"duplicate joint {joint.name}")
        for link in (joint.parent, joint.child):
            if link not in links:
                raise element.fault(f"joint {joint.name}: unknown link {link}")
        if joint.child in parents:
            first = parents[joint.child]
            raise element.fault(f"link {joint.child} has two parents, {first} and {joint.parent}")
        parents[joint.child] = joint.parent
        joints[joint.name] = joint
    for joint in joints.values():
        if joint.mimic is not None and joint.mimic.joint not in joints:
            raise root.fault(f"joint {joint.name} mimics the unknown joint {joint.mimic.joint}")
    return joints, parents


def _links(root: _UrdfElement) -> dict[str, None]:
    links: dict[str, None] = {}
    for element in root.all("link"):
        name = element.required("name")
        if name in links:
            raise element.fault(f"duplicate link {name}")
        if len(links) == MOST_LINKS:
            raise element.fault(f"too many links (limit {MOST_LINKS})")
        links[name] = None
    if not links:
        raise root.fault("the robot has no <link>")
    return links


def _joint(element: _UrdfElement) -> Joint:
    name, type_ = element.required("name"), element.required("type")
    if type_ not in TYPES:
        raise element.fault(f"joint {name}: unknown type {type_}, expected {', '.join(TYPES)}")
    ends = []
    for end in ("parent", "child"):
        found = element.all(end)
        if len(found) != 1:
            raise element.fault(f"joint {name} requires one <{end}>, got {len(found)}")
        ends.append(found[0].required("link"))
    lower, upper = (-inf, inf)
    for limit in element.all("limit")[:1]:
        if type_ != "continuous":
            lower, upper = limit.number("lower", 0.0), limit.number("upper", 0.0)
    mimic = None
    for each in element.all("mimic")[:1]:
        numbers = each.number("multiplier", 1.0), each.number("offset", 0.0)
        mimic = Mimic(each.required("joint"), *numbers)
    origin = Transform()
    for each in element.all("origin")[:1]:
        x, y, z = each.numbers("xyz", 3, (0.0, 0.0, 0.0))
        roll, pitch, yaw = each.numbers("rpy", 3, (0.0, 0.0, 0.0))
        origin = Transform((x, y, z), of_yaw_pitch_roll(yaw, pitch, roll))
    axis: Vector = (1.0, 0.0, 0.0)
    for each in element.all("axis")[:1]:
        x, y, z = each.numbers("xyz", 3, axis)
        length = hypot(x, y, z)
        if type_ in MOVING and length == 0:
            raise each.fault(f"joint {name}: the axis must not be 0 0 0")
        axis = (x / length, y / length, z / length) if length else axis
    return Joint(name, type_, ends[0], ends[1], origin, axis, lower, upper, mimic)


def _reached(root: str, parents: dict[str, str]) -> set[str]:
    """Return the links whose parents lead to the root."""
    reached = {root}
    for link in parents:
        path: list[str] = []
        while link not in reached and link in parents and len(path) <= len(parents):
            path.append(link)
            link = parents[link]
        if link in reached:
            reached.update(path)
    return reached
