"""Messages, services and actions of a workspace's packages."""

from __future__ import annotations

from .conftest import Layout


def test_packages_use_each_others_types_and_the_standard_ones(layout: Layout) -> None:
    layout.messages("b", {"Pair.msg": "a/Num first\na/Num second"}, "a")
    layout.messages("a", {"Num.msg": "Header header\nint64 num"}, "std_msgs")
    assert layout.faults() == []
    assert {"share/a/msg/Num.msg", "share/b/msg/Pair.msg"} <= layout.built()


def test_a_line_that_does_not_parse_is_told_where_it_stands(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\nint33 x y=\n"})
    (fault,) = layout.faults()
    assert fault.startswith("a/msg/Num.msg, line 2: ")
    assert fault.endswith("'int33 x y='")


def test_a_fault_is_told_once_though_others_use_the_type(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64"})
    layout.messages("b", {"Pair.msg": "a/Num first"}, "a")
    (fault,) = layout.faults()
    assert fault.startswith("a/msg/Num.msg, line 1: ")
    assert not layout.devel.exists()


def test_a_package_is_not_built_on_a_broken_one(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64"})
    layout.messages("b", {"Pair.msg": "a/Num first"}, "a")
    assert layout.plan("b").faults


def test_a_type_that_is_not_there_is_told_where_it_is_used(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\n\nstd_msgs/Sting text"}, "std_msgs")
    (fault,) = layout.faults()
    assert fault.startswith("a/msg/Num.msg, line 3: ")
    assert "did you mean std_msgs/String?" in fault


def test_the_packages_of_types_are_to_be_declared(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "int64 num\nstd_msgs/String text"})
    (fault,) = layout.faults()
    assert fault == (
        "a/msg/Num.msg, line 2: generate_messages(DEPENDENCIES std_msgs) is missing in "
        "CMakeLists.txt for this: 'std_msgs/String text'"
    )


def test_what_a_declared_package_depends_on_is_declared_with_it(layout: Layout) -> None:
    layout.messages("a", {"Num.msg": "std_msgs/Header header"}, "geometry_msgs")
    assert layout.faults() == []


def test_services_and_actions_are_compiled_too(layout: Layout) -> None:
    layout.package(
        "a",
        *("message_generation", "message_runtime", "actionlib_msgs"),
        before="add_service_files(FILES Add.srv)\nadd_action_files(FILES Count.action)\n"
        "generate_messages(DEPENDENCIES actionlib_msgs)",
        files={"srv/Add.srv": "int64 a\n---\nint64 b\nint64 b", "action/Count.action": "int32 to"},
    )
    service, action = layout.faults()
    assert service.startswith("a/srv/Add.srv, line 4: duplicate name b")
    assert action.startswith("a/action/Count.action, line 1: expected 2 lines of ---")


def test_a_listed_file_has_to_be_there(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("FILES Num.msg", "FILES Nun.msg msg/Num.msg"))
    assert layout.faults() == [
        "a/CMakeLists.txt, line 4: there is no msg/Nun.msg; did you mean Num.msg?",
        "a/CMakeLists.txt, line 4: write Num.msg: add_message_files() looks in the folder msg/ by "
        "itself",
    ]


def test_a_file_of_another_kind_is_refused(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    (path / "msg" / "Add.srv").write_text("---\n")
    (path / "msg" / "my-own.msg").write_text("")
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("FILES Num.msg", "FILES Add.srv my-own.msg"))
    kind, name = layout.faults()
    assert kind == "a/CMakeLists.txt, line 4: add_message_files() lists .msg files: Add.srv"
    assert name.endswith("the name of a type has letters, digits and _ alone: 'my-own.msg'")


def test_a_file_that_nobody_lists_is_warned_of(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    (path / "msg" / "Other.msg").write_text("int64 num")
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 4: msg/Other.msg is not in add_message_files(FILES ...): nothing "
        "is made of it"
    ]


def test_a_package_of_messages_has_a_name_for_python(layout: Layout) -> None:
    layout.messages("my-msgs", {"Num.msg": "int64 num"})
    (fault,) = layout.faults()
    assert "a package with definitions is named in letters, digits and _ alone" in fault


def test_without_generate_messages_nothing_is_made(layout: Layout) -> None:
    path = layout.messages("a", {"Num.msg": "int64 num"})
    cmake = path / "CMakeLists.txt"
    cmake.write_text(cmake.read_text().replace("generate_messages(DEPENDENCIES )", ""))
    assert layout.warnings() == [
        "a/CMakeLists.txt, line 4: nothing is made of these files: generate_messages() is missing"
    ]
    assert layout.built() == {"share/a/package.xml"}
