"""``fibws srv``."""

from __future__ import annotations

from hub_in_thread import Run

from fibws.client.hub_client import HubClient


def test_show_prints_as_rossrv(run: Run) -> None:
    assert run("srv", "show", "std_srvs/SetBool").output.splitlines() == [
        "bool data",
        "---",
        "bool success",
        "string message",
        "",
    ]
    assert run("srv", "show", "std_srvs/Empty").output == "---\n\n"
    shown = run("srv", "show", "AddTwoInts").output
    part = "int64 a\nint64 b\n---\nint64 sum\n\n"
    assert shown == f"[example_interfaces/AddTwoInts]:\n{part}[rospy_tutorials/AddTwoInts]:\n{part}"


def test_raw_prints_both_parts_of_the_file(run: Run) -> None:
    assert run("srv", "show", "-r", "std_srvs/SetBool.srv").output.split() == (
        "bool data --- bool success string message".split()
    )


def test_unknown_types_are_requested_from_the_hub(run: Run, client: HubClient) -> None:
    client.send(
        {
            "op": "advertise_service",
            "service": "/odd",
            "type": "hub_srvs/Odd",
            "definition": "int32 x\n---\n",
        }
    )
    client.call("/rosapi/get_time")
    assert run("srv", "show", "hub_srvs/Odd").output == "int32 x\n---\n\n"


def test_md5_is_that_of_ros_1(run: Run) -> None:
    assert run("srv", "md5", "std_srvs/SetBool").output == "09fb03525b03e7ea1fd3992bafd87e16\n"


def test_list_package_and_packages(run: Run) -> None:
    found = run("srv", "list").output.splitlines()
    assert "std_srvs/SetBool" in found
    assert "std_msgs/Int32" not in found
    assert run("srv", "package", "-s", "std_srvs").output == (
        "std_srvs/Empty std_srvs/SetBool std_srvs/Trigger\n"
    )
    packages = run("srv", "packages").output.splitlines()
    assert "std_srvs" in packages
    assert "std_msgs" not in packages


def test_unknown_type_is_an_error(run: Run) -> None:
    result = run("srv", "show", "std_srvs/SetBol")
    assert (result.exit_code, result.stdout) == (1, "")
    assert "std_srvs/SetBol:" in result.stderr
    assert result.stderr.endswith("; did you mean std_srvs/SetBool?\n")
