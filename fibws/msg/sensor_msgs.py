"""The messages of sensor_msgs, written by fibws.interfaces.generator: do not edit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import fibws.interfaces as ros
from fibws.msg import geometry_msgs, std_msgs

__all__ = [
    "BatteryState",
    "CameraInfo",
    "ChannelFloat32",
    "CompressedImage",
    "FluidPressure",
    "Illuminance",
    "Image",
    "Imu",
    "JointState",
    "Joy",
    "JoyFeedback",
    "JoyFeedbackArray",
    "LaserEcho",
    "LaserScan",
    "MagneticField",
    "MultiDOFJointState",
    "MultiEchoLaserScan",
    "NavSatFix",
    "NavSatStatus",
    "PointCloud",
    "PointCloud2",
    "PointField",
    "Range",
    "RegionOfInterest",
    "RelativeHumidity",
    "Temperature",
    "TimeReference",
]


@dataclass(slots=True, eq=False, repr=False)
class BatteryState(ros.Message):
    """sensor_msgs/BatteryState"""

    _type: ClassVar[str] = "sensor_msgs/BatteryState"
    POWER_SUPPLY_STATUS_UNKNOWN: ClassVar[int] = 0
    POWER_SUPPLY_STATUS_CHARGING: ClassVar[int] = 1
    POWER_SUPPLY_STATUS_DISCHARGING: ClassVar[int] = 2
    POWER_SUPPLY_STATUS_NOT_CHARGING: ClassVar[int] = 3
    POWER_SUPPLY_STATUS_FULL: ClassVar[int] = 4
    POWER_SUPPLY_HEALTH_UNKNOWN: ClassVar[int] = 0
    POWER_SUPPLY_HEALTH_GOOD: ClassVar[int] = 1
    POWER_SUPPLY_HEALTH_OVERHEAT: ClassVar[int] = 2
    POWER_SUPPLY_HEALTH_DEAD: ClassVar[int] = 3
    POWER_SUPPLY_HEALTH_OVERVOLTAGE: ClassVar[int] = 4
    POWER_SUPPLY_HEALTH_UNSPEC_FAILURE: ClassVar[int] = 5
    POWER_SUPPLY_HEALTH_COLD: ClassVar[int] = 6
    POWER_SUPPLY_HEALTH_WATCHDOG_TIMER_EXPIRE: ClassVar[int] = 7
    POWER_SUPPLY_HEALTH_SAFETY_TIMER_EXPIRE: ClassVar[int] = 8
    POWER_SUPPLY_TECHNOLOGY_UNKNOWN: ClassVar[int] = 0
    POWER_SUPPLY_TECHNOLOGY_NIMH: ClassVar[int] = 1
    POWER_SUPPLY_TECHNOLOGY_LION: ClassVar[int] = 2
    POWER_SUPPLY_TECHNOLOGY_LIPO: ClassVar[int] = 3
    POWER_SUPPLY_TECHNOLOGY_LIFE: ClassVar[int] = 4
    POWER_SUPPLY_TECHNOLOGY_NICD: ClassVar[int] = 5
    POWER_SUPPLY_TECHNOLOGY_LIMN: ClassVar[int] = 6

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    voltage: float = 0.0
    temperature: float = 0.0
    current: float = 0.0
    charge: float = 0.0
    capacity: float = 0.0
    design_capacity: float = 0.0
    percentage: float = 0.0
    power_supply_status: int = 0
    power_supply_health: int = 0
    power_supply_technology: int = 0
    present: bool = False
    cell_voltage: list[float] = field(default_factory=list)
    cell_temperature: list[float] = field(default_factory=list)
    location: str = ""
    serial_number: str = ""


@dataclass(slots=True, eq=False, repr=False)
class RegionOfInterest(ros.Message):
    """sensor_msgs/RegionOfInterest"""

    _type: ClassVar[str] = "sensor_msgs/RegionOfInterest"

    x_offset: int = 0
    y_offset: int = 0
    height: int = 0
    width: int = 0
    do_rectify: bool = False


@dataclass(slots=True, eq=False, repr=False)
class CameraInfo(ros.Message):
    """sensor_msgs/CameraInfo"""

    _type: ClassVar[str] = "sensor_msgs/CameraInfo"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    height: int = 0
    width: int = 0
    distortion_model: str = ""
    D: list[float] = field(default_factory=list)
    K: list[float] = field(default_factory=lambda: [0.0] * 9)
    R: list[float] = field(default_factory=lambda: [0.0] * 9)
    P: list[float] = field(default_factory=lambda: [0.0] * 12)
    binning_x: int = 0
    binning_y: int = 0
    roi: RegionOfInterest = field(default_factory=lambda: RegionOfInterest())


@dataclass(slots=True, eq=False, repr=False)
class ChannelFloat32(ros.Message):
    """sensor_msgs/ChannelFloat32"""

    _type: ClassVar[str] = "sensor_msgs/ChannelFloat32"

    name: str = ""
    values: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class CompressedImage(ros.Message):
    """sensor_msgs/CompressedImage"""

    _type: ClassVar[str] = "sensor_msgs/CompressedImage"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    format: str = ""
    data: bytes = b""


@dataclass(slots=True, eq=False, repr=False)
class FluidPressure(ros.Message):
    """sensor_msgs/FluidPressure"""

    _type: ClassVar[str] = "sensor_msgs/FluidPressure"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    fluid_pressure: float = 0.0
    variance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Illuminance(ros.Message):
    """sensor_msgs/Illuminance"""

    _type: ClassVar[str] = "sensor_msgs/Illuminance"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    illuminance: float = 0.0
    variance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Image(ros.Message):
    """sensor_msgs/Image"""

    _type: ClassVar[str] = "sensor_msgs/Image"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    height: int = 0
    width: int = 0
    encoding: str = ""
    is_bigendian: int = 0
    step: int = 0
    data: bytes = b""


@dataclass(slots=True, eq=False, repr=False)
class Imu(ros.Message):
    """sensor_msgs/Imu"""

    _type: ClassVar[str] = "sensor_msgs/Imu"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    orientation: geometry_msgs.Quaternion = field(
        default_factory=lambda: geometry_msgs.Quaternion()
    )
    orientation_covariance: list[float] = field(default_factory=lambda: [0.0] * 9)
    angular_velocity: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    angular_velocity_covariance: list[float] = field(default_factory=lambda: [0.0] * 9)
    linear_acceleration: geometry_msgs.Vector3 = field(
        default_factory=lambda: geometry_msgs.Vector3()
    )
    linear_acceleration_covariance: list[float] = field(default_factory=lambda: [0.0] * 9)


@dataclass(slots=True, eq=False, repr=False)
class JointState(ros.Message):
    """sensor_msgs/JointState"""

    _type: ClassVar[str] = "sensor_msgs/JointState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    name: list[str] = field(default_factory=list)
    position: list[float] = field(default_factory=list)
    velocity: list[float] = field(default_factory=list)
    effort: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class Joy(ros.Message):
    """sensor_msgs/Joy"""

    _type: ClassVar[str] = "sensor_msgs/Joy"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    axes: list[float] = field(default_factory=list)
    buttons: list[int] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class JoyFeedback(ros.Message):
    """sensor_msgs/JoyFeedback"""

    _type: ClassVar[str] = "sensor_msgs/JoyFeedback"
    TYPE_LED: ClassVar[int] = 0
    TYPE_RUMBLE: ClassVar[int] = 1
    TYPE_BUZZER: ClassVar[int] = 2

    type: int = 0
    id: int = 0
    intensity: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class JoyFeedbackArray(ros.Message):
    """sensor_msgs/JoyFeedbackArray"""

    _type: ClassVar[str] = "sensor_msgs/JoyFeedbackArray"

    array: list[JoyFeedback] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class LaserEcho(ros.Message):
    """sensor_msgs/LaserEcho"""

    _type: ClassVar[str] = "sensor_msgs/LaserEcho"

    echoes: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class LaserScan(ros.Message):
    """sensor_msgs/LaserScan"""

    _type: ClassVar[str] = "sensor_msgs/LaserScan"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    angle_min: float = 0.0
    angle_max: float = 0.0
    angle_increment: float = 0.0
    time_increment: float = 0.0
    scan_time: float = 0.0
    range_min: float = 0.0
    range_max: float = 0.0
    ranges: list[float] = field(default_factory=list)
    intensities: list[float] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MagneticField(ros.Message):
    """sensor_msgs/MagneticField"""

    _type: ClassVar[str] = "sensor_msgs/MagneticField"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    magnetic_field: geometry_msgs.Vector3 = field(default_factory=lambda: geometry_msgs.Vector3())
    magnetic_field_covariance: list[float] = field(default_factory=lambda: [0.0] * 9)


@dataclass(slots=True, eq=False, repr=False)
class MultiDOFJointState(ros.Message):
    """sensor_msgs/MultiDOFJointState"""

    _type: ClassVar[str] = "sensor_msgs/MultiDOFJointState"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    joint_names: list[str] = field(default_factory=list)
    transforms: list[geometry_msgs.Transform] = field(default_factory=list)
    twist: list[geometry_msgs.Twist] = field(default_factory=list)
    wrench: list[geometry_msgs.Wrench] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class MultiEchoLaserScan(ros.Message):
    """sensor_msgs/MultiEchoLaserScan"""

    _type: ClassVar[str] = "sensor_msgs/MultiEchoLaserScan"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    angle_min: float = 0.0
    angle_max: float = 0.0
    angle_increment: float = 0.0
    time_increment: float = 0.0
    scan_time: float = 0.0
    range_min: float = 0.0
    range_max: float = 0.0
    ranges: list[LaserEcho] = field(default_factory=list)
    intensities: list[LaserEcho] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class NavSatStatus(ros.Message):
    """sensor_msgs/NavSatStatus"""

    _type: ClassVar[str] = "sensor_msgs/NavSatStatus"
    STATUS_NO_FIX: ClassVar[int] = -1
    STATUS_FIX: ClassVar[int] = 0
    STATUS_SBAS_FIX: ClassVar[int] = 1
    STATUS_GBAS_FIX: ClassVar[int] = 2
    SERVICE_GPS: ClassVar[int] = 1
    SERVICE_GLONASS: ClassVar[int] = 2
    SERVICE_COMPASS: ClassVar[int] = 4
    SERVICE_GALILEO: ClassVar[int] = 8

    status: int = 0
    service: int = 0


@dataclass(slots=True, eq=False, repr=False)
class NavSatFix(ros.Message):
    """sensor_msgs/NavSatFix"""

    _type: ClassVar[str] = "sensor_msgs/NavSatFix"
    COVARIANCE_TYPE_UNKNOWN: ClassVar[int] = 0
    COVARIANCE_TYPE_APPROXIMATED: ClassVar[int] = 1
    COVARIANCE_TYPE_DIAGONAL_KNOWN: ClassVar[int] = 2
    COVARIANCE_TYPE_KNOWN: ClassVar[int] = 3

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    status: NavSatStatus = field(default_factory=lambda: NavSatStatus())
    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0
    position_covariance: list[float] = field(default_factory=lambda: [0.0] * 9)
    position_covariance_type: int = 0


@dataclass(slots=True, eq=False, repr=False)
class PointCloud(ros.Message):
    """sensor_msgs/PointCloud"""

    _type: ClassVar[str] = "sensor_msgs/PointCloud"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    points: list[geometry_msgs.Point32] = field(default_factory=list)
    channels: list[ChannelFloat32] = field(default_factory=list)


@dataclass(slots=True, eq=False, repr=False)
class PointField(ros.Message):
    """sensor_msgs/PointField"""

    _type: ClassVar[str] = "sensor_msgs/PointField"
    INT8: ClassVar[int] = 1
    UINT8: ClassVar[int] = 2
    INT16: ClassVar[int] = 3
    UINT16: ClassVar[int] = 4
    INT32: ClassVar[int] = 5
    UINT32: ClassVar[int] = 6
    FLOAT32: ClassVar[int] = 7
    FLOAT64: ClassVar[int] = 8

    name: str = ""
    offset: int = 0
    datatype: int = 0
    count: int = 0


@dataclass(slots=True, eq=False, repr=False)
class PointCloud2(ros.Message):
    """sensor_msgs/PointCloud2"""

    _type: ClassVar[str] = "sensor_msgs/PointCloud2"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    height: int = 0
    width: int = 0
    fields: list[PointField] = field(default_factory=list)
    is_bigendian: bool = False
    point_step: int = 0
    row_step: int = 0
    data: bytes = b""
    is_dense: bool = False


@dataclass(slots=True, eq=False, repr=False)
class Range(ros.Message):
    """sensor_msgs/Range"""

    _type: ClassVar[str] = "sensor_msgs/Range"
    ULTRASOUND: ClassVar[int] = 0
    INFRARED: ClassVar[int] = 1

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    radiation_type: int = 0
    field_of_view: float = 0.0
    min_range: float = 0.0
    max_range: float = 0.0
    range: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class RelativeHumidity(ros.Message):
    """sensor_msgs/RelativeHumidity"""

    _type: ClassVar[str] = "sensor_msgs/RelativeHumidity"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    relative_humidity: float = 0.0
    variance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class Temperature(ros.Message):
    """sensor_msgs/Temperature"""

    _type: ClassVar[str] = "sensor_msgs/Temperature"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    temperature: float = 0.0
    variance: float = 0.0


@dataclass(slots=True, eq=False, repr=False)
class TimeReference(ros.Message):
    """sensor_msgs/TimeReference"""

    _type: ClassVar[str] = "sensor_msgs/TimeReference"

    header: std_msgs.Header = field(default_factory=lambda: std_msgs.Header())
    time_ref: ros.Time = field(default_factory=ros.Time)
    source: str = ""
