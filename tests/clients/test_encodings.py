"""Messages in CBOR, with each client that knows it."""

from __future__ import annotations

from typing import Any

import pytest

from .casts import playing

pytestmark = playing("encodings")


STAMP = {"secs": 1, "nsecs": 2}


def test_laser_scan_arrives_by_cbor(seen: Any) -> None:
    assert seen["header"] == {"seq": 1, "stamp": STAMP, "frame_id": "laser"}
    assert (seen["angle_min"], seen["ranges"]) == (-1.5, {"Float32Array": [0.5, 1.25, -3]})
    assert seen["intensities"] == {"Float32Array": []}


def test_pose_with_covariance_arrives_by_cbor(seen: Any) -> None:
    assert seen["pose"]["position"] == {"x": 1, "y": 2, "z": 3}
    assert seen["covariance"] == {"Float64Array": [index / 4 for index in range(36)]}


def test_image_arrives_by_cbor(seen: Any) -> None:
    assert (seen["width"], seen["encoding"]) == (2, "rgb8")
    assert seen["data"] == {"Uint8Array": [255, 0, 1, 2, 3, 254]}


def test_arrays_of_integers_arrive_by_cbor(seen: Any) -> None:
    assert seen == {
        "Int8": {"Int8Array": [-1, 127]},
        "UInt16": {"Uint16Array": [65535]},
        "Int16": {"Int16Array": [-2]},
        "UInt32": {"Uint32Array": [7]},
        "Int32": {"Int32Array": [-8, 9]},
    }


def test_nan_arrives_by_cbor(seen: Any) -> None:
    assert seen == "NaN"


def test_message_arrives_by_cbor_raw(seen: Any) -> None:
    text = "héllo".encode()
    assert bytes(seen["bytes"]["Uint8Array"]) == len(text).to_bytes(4, "little") + text
    assert seen["age"] == pytest.approx(0, abs=20)
