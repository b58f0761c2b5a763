"""The messages of visualization_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs

__all__ = [
    "ImageMarker",
    "InteractiveMarker",
    "InteractiveMarkerControl",
    "InteractiveMarkerFeedback",
    "InteractiveMarkerInit",
    "InteractiveMarkerPose",
    "InteractiveMarkerUpdate",
    "Marker",
    "MarkerArray",
    "MenuEntry",
]


@dataclass(slots=True, eq=False, repr=False)
class ImageMarker(ros.Message):
    """visualization_msgs/ImageMarker"""

    _type: ClassVar[str] = "visualization_msgs/ImageMarker"
    CIRCLE: ClassVar[int] = 0
    LINE_STRIP: ClassVar[int] = 1
    LINE_LIST: ClassVar[int] = 2
    POLYGON: ClassVar[int] = 3
    POINTS: ClassVar[int] = 4
    ADD: ClassVar[int] = 0
    REMOVE: ClassVar[int] = 1

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    ns: str = ""
    id: int = 0
    type: int = 0
    action: int = 0
    position: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())
    scale: float = 0.0
    outline_color: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    filled: int = 0
    fill_color: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    lifetime: ros.Duration = field(default_factory=ros.Duration)
    points: list[geometry_msgs.Point] = field(default_factory=list)
    outline_colors: list[std_msgs.ColorRGBA] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MenuEntry(ros.Message):
    """visualization_msgs/MenuEntry"""

    _type: ClassVar[str] = "visualization_msgs/MenuEntry"
    FEEDBACK: ClassVar[int] = 0
    ROSRUN: ClassVar[int] = 1
    ROSLAUNCH: ClassVar[int] = 2

    id: int = 0
    parent_id: int = 0
    title: str = ""
    command: str = ""
    command_type: int = 0


@dataclass(slots=True, eq=False, repr=False)
class Marker(ros.Message):
    """visualization_msgs/Marker"""

    _type: ClassVar[str] = "visualization_msgs/Marker"
    ARROW: ClassVar[int] = 0
    CUBE: ClassVar[int] = 1
    SPHERE: ClassVar[int] = 2
    CYLINDER: ClassVar[int] = 3
    LINE_STRIP: ClassVar[int] = 4
    LINE_LIST: ClassVar[int] = 5
    CUBE_LIST: ClassVar[int] = 6
    SPHERE_LIST: ClassVar[int] = 7
    POINTS: ClassVar[int] = 8
    TEXT_VIEW_FACING: ClassVar[int] = 9
    MESH_RESOURCE: ClassVar[int] = 10
    TRIANGLE_LIST: ClassVar[int] = 11
    ADD: ClassVar[int] = 0
    MODIFY: ClassVar[int] = 0
    DELETE: ClassVar[int] = 2
    DELETEALL: ClassVar[int] = 3

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    ns: str = ""
    id: int = 0
    type: int = 0
    action: int = 0
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    scale: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    color: std_msgs.ColorRGBA = field(default_factory=lambda: std_msgs.ColorRGBA())
    lifetime: ros.Duration = field(default_factory=ros.Duration)
    frame_locked: bool = False
    points: list[geometry_msgs.Point] = field(default_factory=list)
    colors: list[std_msgs.ColorRGBA] = field(default_factory=list)
    text: str = ""
    mesh_resource: str = ""
    mesh_use_embedded_materials: bool = False


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarkerControl(ros.Message):
    """visualization_msgs/InteractiveMarkerControl"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarkerControl"
    INHERIT: ClassVar[int] = 0
    FIXED: ClassVar[int] = 1
    VIEW_FACING: ClassVar[int] = 2
    NONE: ClassVar[int] = 0
    MENU: ClassVar[int] = 1
    BUTTON: ClassVar[int] = 2
    MOVE_AXIS: ClassVar[int] = 3
    MOVE_PLANE: ClassVar[int] = 4
    ROTATE_AXIS: ClassVar[int] = 5
    MOVE_ROTATE: ClassVar[int] = 6
    MOVE_3D: ClassVar[int] = 7
    ROTATE_3D: ClassVar[int] = 8
    MOVE_ROTATE_3D: ClassVar[int] = 9

    name: str = ""
    orientation: geometry_msgs.Quaternion = field(
        default_factory=lambda: geometry_msgs.Quaternion()
    )
    orientation_mode: int = 0
    interaction_mode: int = 0
    always_visible: bool = False
    markers: list[Marker] = field(default_factory=list)
    independent_marker_orientation: bool = False
    description: str = ""


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarker(ros.Message):
    """visualization_msgs/InteractiveMarker"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarker"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    name: str = ""
    description: str = ""
    scale: float = 0.0
    menu_entries: list[MenuEntry] = field(default_factory=list)
    controls: list[InteractiveMarkerControl] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarkerFeedback(ros.Message):
    """visualization_msgs/InteractiveMarkerFeedback"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarkerFeedback"
    KEEP_ALIVE: ClassVar[int] = 0
    POSE_UPDATE: ClassVar[int] = 1
    MENU_SELECT: ClassVar[int] = 2
    BUTTON_CLICK: ClassVar[int] = 3
    MOUSE_DOWN: ClassVar[int] = 4
    MOUSE_UP: ClassVar[int] = 5

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    client_id: str = ""
    marker_name: str = ""
    control_name: str = ""
    event_type: int = 0
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    menu_entry_id: int = 0
    mouse_point: geometry_msgs.Point = field(default_factory=lambda: geometry_msgs.Point())
    mouse_point_valid: bool = False


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarkerInit(ros.Message):
    """visualization_msgs/InteractiveMarkerInit"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarkerInit"

    server_id: str = ""
    seq_num: int = 0
    markers: list[InteractiveMarker] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarkerPose(ros.Message):
    """visualization_msgs/InteractiveMarkerPose"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarkerPose"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    name: str = ""


@dataclass(slots=True, eq=False, repr=False)
class InteractiveMarkerUpdate(ros.Message):
    """visualization_msgs/InteractiveMarkerUpdate"""

    _type: ClassVar[str] = "visualization_msgs/InteractiveMarkerUpdate"
    KEEP_ALIVE: ClassVar[int] = 0
    UPDATE: ClassVar[int] = 1

    server_id: str = ""
    seq_num: int = 0
    type: int = 0
    markers: list[InteractiveMarker] = field(default_factory=list)
    poses: list[InteractiveMarkerPose] = field(default_factory=list)
    erases: list[str] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MarkerArray(ros.Message):
    """visualization_msgs/MarkerArray"""

    _type: ClassVar[str] = "visualization_msgs/MarkerArray"

    markers: list[Marker] = field(default_factory=list)
