"""The messages of object_recognition_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import actionlib_msgs, geometry_msgs, sensor_msgs, shape_msgs, std_msgs

__all__ = [
    "ObjectInformation",
    "ObjectRecognitionAction",
    "ObjectRecognitionActionFeedback",
    "ObjectRecognitionActionGoal",
    "ObjectRecognitionActionResult",
    "ObjectRecognitionFeedback",
    "ObjectRecognitionGoal",
    "ObjectRecognitionResult",
    "ObjectType",
    "RecognizedObject",
    "RecognizedObjectArray",
    "Table",
    "TableArray",
]


@dataclass(slots=True, eq=False, repr=False)
class ObjectInformation(ros.Message):
    """object_recognition_msgs/ObjectInformation"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectInformation"

    name: str = ""
    ground_truth_mesh: shape_msgs.Mesh = field(default_factory=lambda: shape_msgs.Mesh())
    ground_truth_point_cloud: sensor_msgs.PointCloud2 = field(
        default_factory=lambda: sensor_msgs.PointCloud2()
    )


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionGoal(ros.Message):
    """object_recognition_msgs/ObjectRecognitionGoal"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionGoal"

    use_roi: bool = False
    filter_limits: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionActionGoal(ros.Message):
    """object_recognition_msgs/ObjectRecognitionActionGoal"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionActionGoal"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    goal_id: actionlib_msgs.GoalID = field(default_factory=lambda: actionlib_msgs.GoalID())
    goal: ObjectRecognitionGoal = field(default_factory=lambda: ObjectRecognitionGoal())


@dataclass(slots=True, eq=False, repr=False)
class ObjectType(ros.Message):
    """object_recognition_msgs/ObjectType"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectType"

    key: str = ""
    db: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RecognizedObject(ros.Message):
    """object_recognition_msgs/RecognizedObject"""

    _type: ClassVar[str] = "object_recognition_msgs/RecognizedObject"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    type: ObjectType = field(default_factory=lambda: ObjectType())
    confidence: float = 0.0
    point_clouds: list[sensor_msgs.PointCloud2] = field(default_factory=list)
    bounding_mesh: shape_msgs.Mesh = field(default_factory=lambda: shape_msgs.Mesh())
    bounding_contours: list[geometry_msgs.Point] = field(default_factory=list)
    pose: geometry_msgs.PoseWithCovarianceStamped = field(
        default_factory=lambda: geometry_msgs.PoseWithCovarianceStamped()
    )


@dataclass(slots=True, eq=False, repr=False)
class RecognizedObjectArray(ros.Message):
    """object_recognition_msgs/RecognizedObjectArray"""

    _type: ClassVar[str] = "object_recognition_msgs/RecognizedObjectArray"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    objects: list[RecognizedObject] = field(default_factory=list)
    cooccurrence: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionResult(ros.Message):
    """object_recognition_msgs/ObjectRecognitionResult"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionResult"

    recognized_objects: RecognizedObjectArray = field(
        default_factory=lambda: RecognizedObjectArray()
    )


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionActionResult(ros.Message):
    """object_recognition_msgs/ObjectRecognitionActionResult"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionActionResult"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    result: ObjectRecognitionResult = field(default_factory=lambda: ObjectRecognitionResult())


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionFeedback(ros.Message):
    """object_recognition_msgs/ObjectRecognitionFeedback"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionFeedback"


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionActionFeedback(ros.Message):
    """object_recognition_msgs/ObjectRecognitionActionFeedback"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionActionFeedback"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: actionlib_msgs.GoalStatus = field(default_factory=lambda: actionlib_msgs.GoalStatus())
    feedback: ObjectRecognitionFeedback = field(default_factory=lambda: ObjectRecognitionFeedback())


@dataclass(slots=True, eq=False, repr=False)
class ObjectRecognitionAction(ros.Message):
    """object_recognition_msgs/ObjectRecognitionAction"""

    _type: ClassVar[str] = "object_recognition_msgs/ObjectRecognitionAction"

    action_goal: ObjectRecognitionActionGoal = field(
        default_factory=lambda: ObjectRecognitionActionGoal()
    )
    action_result: ObjectRecognitionActionResult = field(
        default_factory=lambda: ObjectRecognitionActionResult()
    )
    action_feedback: ObjectRecognitionActionFeedback = field(
        default_factory=lambda: ObjectRecognitionActionFeedback()
    )


@dataclass(slots=True, eq=False, repr=False)
class Table(ros.Message):
    """object_recognition_msgs/Table"""

    _type: ClassVar[str] = "object_recognition_msgs/Table"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    pose: geometry_msgs.Pose = field(default_factory=lambda: geometry_msgs.Pose())
    convex_hull: list[geometry_msgs.Point] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class TableArray(ros.Message):
    """object_recognition_msgs/TableArray"""

    _type: ClassVar[str] = "object_recognition_msgs/TableArray"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    tables: list[Table] = field(default_factory=list)
