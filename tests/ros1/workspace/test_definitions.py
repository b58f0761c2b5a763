"""Messages, services and actions of a workspace's packages."""

from __future__ import annotations

from .conftest import Layout


def test_packages_use_each_others_types_and_the_standard_ones(layout: Layout) -> None:
    layout.messages("b", {"Pair.msg": "a/Num first\na/Num second"}, "a")
    layout.messages("a", {"Num.msg": "Header header\nint64 num"}, "std_msgs")
    assert layout.errors() == []
    assert {"share/a/msg/Num.msg", "share/b/msg/Pair.msg"} <= layout.built()


def test_invalid_line_is_an_error_with_its_number(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\nint33 x y=\n"})
    (error,) = layout.errors()
    assert error.startswith("a/msg/Num.msg, line 2: ")
    assert error.endswith("'int33 x y='")


def test_error_is_reported_once_though_others_use_the_type(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64"})
    layout.messages("b", {"Pair.msg": "a/Num first"}, "a")
    layout.messages("c", {"Pair.msg": "a/Num first"})
    (error,) = layout.errors()
    assert error.startswith("a/msg/Num.msg, line 1: ")
    assert layout.plan().failed.keys() == {"a", "b", "c"}


def test_unknown_type_is_an_error_where_it_is_used(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\n\nstd_msgs/Sting text"}, "std_msgs")
    (error,) = layout.errors()
    assert error.startswith("a/msg/Num.msg, line 3: ")
    assert "did you mean std_msgs/String?" in error


def test_undeclared_package_of_types_is_warned_of(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\nstd_msgs/String text"})
    (warning,) = layout.warnings()
    assert warning.startswith("a/msg/Num.msg, line 2: ")
    assert "generate_messages(DEPENDENCIES std_msgs)" in warning
    assert "share/a/msg/Num.msg" in layout.built()


def test_packages_used_by_a_declared_package_need_no_declaration(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "std_msgs/Header header"}, "geometry_msgs")
    assert layout.warnings() == []


def test_services_and_actions_are_compiled_too(layout: Layout) -> None:
    layout.package(
        "a",
        *("message_generation", "message_runtime", "actionlib_msgs"),
        before="add_service_files(FILES Add.srv)\nadd_action_files(FILES Count.action)\n"
        "generate_messages(DEPENDENCIES actionlib_msgs)",
        files={"srv/Add.srv": "int64 a\n---\nint64 b\nint64 b", "action/Count.action": "int32 to"},
    )
    service, action = layout.errors()
    assert service.startswith("a/srv/Add.srv, line 4: ")
    assert action.startswith("a/action/Count.action, line 1: ")


def test_listed_file_that_does_not_exist_is_an_error(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("FILES Num.msg", "FILES Nun.msg msg/Num.msg"))
    misspelt, with_folder = layout.errors()
    assert misspelt.startswith("a/CMakeLists.txt, line 4: ") and "mean Num.msg?" in misspelt
    assert with_folder.startswith("a/CMakeLists.txt, line 4: write Num.msg")


def test_file_of_another_kind_is_an_error(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    (path / "msg" / "Add.srv").write_text("---\n")
    (path / "msg" / "my-own.msg").write_text("")
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("FILES Num.msg", "FILES Add.srv my-own.msg"))
    kind, name = layout.errors()
    assert kind.startswith("a/CMakeLists.txt, line 4: ") and "Add.srv" in kind
    assert name.startswith("a/CMakeLists.txt, line 4: ") and "my-own.msg" in name


def test_file_that_is_not_listed_is_warned_of(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    (path / "msg" / "Other.msg").write_text("int64 num")
    (warning,) = layout.warnings()
    assert warning.startswith("a/CMakeLists.txt, line 4: msg/Other.msg ")


def test_name_of_a_package_of_messages_must_be_an_identifier(layout: Layout) -> None:
    layout.messages("my-msgs", {"Num.msg": "int64 num"})
    (error,) = layout.errors()
    assert "my-msgs" in error and "letters, digits and _" in error


def test_without_generate_messages_nothing_is_generated(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("generate_messages(DEPENDENCIES )", ""))
    (warning,) = layout.warnings()
    assert warning.startswith("a/CMakeLists.txt, line 4: generate_messages() is missing")
    assert layout.built() == {"share/a/package.xml"}
