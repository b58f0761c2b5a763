"""``fibws topic find``."""

from __future__ import annotations

from hub_in_thread import Publish, Run


def test_the_topics_of_a_type_are_found(run: Run, publish: Publish) -> None:
    publish("/b", "std_msgs/String")
    publish("/a", "std_msgs/String")
    assert run("topic", "find", "std_msgs/String").output == "/a\n/b\n"
    assert run("topic", "find", "std_msgs/msg/String").output == "/a\n/b\n"
    assert run("topic", "find", "--json", "std_msgs/String").output == '"/a"\n"/b"\n'


def test_a_type_may_have_no_topics(run: Run) -> None:
    result = run("topic", "find", "std_msgs/String")
    assert (result.exit_code, result.output) == (0, "")


def test_a_type_without_its_package_is_an_error(run: Run) -> None:
    result = run("topic", "find", "String")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "did you mean std_msgs/String?" in result.stderr
