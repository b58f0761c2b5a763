"""Clients may bring types: whole, no others than those that are known, and only so many."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import pytest

from fibws.errors import (
    DefinitionError,
    DefinitionLimit,
    InterfaceError,
    UnknownPackage,
    UnknownType,
)
from fibws.interfaces import Interfaces, client_definitions, full_text
from fibws.interfaces.catalogue import Definitions
from fibws.interfaces.client_definitions import ClientDefinitions, DefinitionLimits
from fibws.interfaces.definition import (
    ActionDefinition,
    Field,
    MessageDefinition,
    ServiceDefinition,
)
from fibws.interfaces.folders import Kind

SEPARATOR = "=" * 80
POINT = f"{SEPARATOR}\nMSG: new_msgs/Point\nint32 x\n"


class Keeper(ClientDefinitions):
    """Definitions of clients, each held from when it is brought."""

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        self.interfaces = Interfaces(folders)
        super().__init__(self.interfaces)

    def bring(self, kind: Kind, name: str, text: str, client: str = "/client") -> Definitions:
        """Hold a definition as its client; return where its type is looked up."""
        definition = self.read(kind, Interfaces.canonical(name), text, client)
        if definition is not None:
            self.hold(definition, (client, kind, name))
        return definition or self.interfaces

    def drop(self, kind: Kind, name: str, client: str = "/client") -> bool:
        """Release a definition; return whether it is forgotten."""
        definition = self.find(kind, name)
        return definition is not None and self.release(definition, (client, kind, name))

    def learn(self, name: str, text: str) -> MessageDefinition:
        return self.bring("msg", name, text).message(name)

    def learn_service(self, name: str, text: str) -> ServiceDefinition:
        return self.bring("srv", name, text).service(name)

    def learn_action(self, name: str, text: str) -> ActionDefinition:
        return self.bring("action", name, text).action(name)

    def names(self) -> list[str]:
        """Return all types that clients brought, sorted."""
        return sorted(name for _, name in self._by_type)


def limit(monkeypatch: pytest.MonkeyPatch, name: str = "PER_CLIENT", **limits: int) -> None:
    """Change limits of one client, or of all."""
    changed: DefinitionLimits = getattr(client_definitions, name)._replace(**limits)
    monkeypatch.setattr(client_definitions, name, changed)


def test_client_may_define_a_type() -> None:
    interfaces = Keeper()
    text = f"Inner inner\nHeader h\n{SEPARATOR}\nMSG: new_msgs/Inner\nint32 x\n"
    assert interfaces.learn("new_msgs/msg/Outer", text).type == "new_msgs/Outer"
    assert interfaces.message("new_msgs/Inner").fields == (Field("x", "int32"),)
    assert interfaces.names() == ["new_msgs/Inner", "new_msgs/Outer"]


def test_type_is_known_only_while_it_is_used() -> None:
    definitions = ClientDefinitions(Interfaces())
    text = f"Point point\n{POINT}"
    definition = definitions.read("msg", "new_msgs/Outer", text, "/client")
    assert definition is not None
    with pytest.raises(UnknownPackage):
        definitions.message("new_msgs/Outer")
    for holder in ("first", "second"):
        definitions.hold(definition, holder)
    assert definitions.message("new_msgs/Point") is definition.message("new_msgs/Point")
    assert definitions.read("msg", "new_msgs/Outer", text, "/other") is definition
    assert not definitions.release(definition, "first")
    assert not definitions.release(definition, "first")
    assert definitions.find("msg", "new_msgs/Outer") is definition
    assert definitions.release(definition, "second")
    assert definitions.find("msg", "new_msgs/Outer") is None
    assert definitions.find("msg", "new_msgs/Point") is None
    with pytest.raises(UnknownPackage):
        definitions.full_text("new_msgs/Outer")


def test_forgotten_type_may_be_defined_with_other_fields() -> None:
    definitions = Keeper()
    texts: dict[Kind, str] = {"msg": "{} x", "srv": "{} x\n---", "action": "{} x\n---\n---"}
    for kind, text in texts.items():
        for number in ("int8", "int16"):
            definitions.bring(kind, "new_msgs/Mine", text.format(number))
            assert definitions.drop(kind, "new_msgs/Mine")
    assert definitions.names() == []


def test_forgotten_type_still_works_for_its_users() -> None:
    definitions = Keeper()
    older = definitions.bring("msg", "new_msgs/Outer", f"Point point\n{POINT}")
    definitions.drop("msg", "new_msgs/Outer")
    definitions.learn("new_msgs/Outer", "float64 x")
    definitions.learn("new_msgs/Point", "float64 x")
    assert older.message("new_msgs/Outer").fields[0].type == "new_msgs/Point"
    assert older.message("new_msgs/Point").fields == (Field("x", "int32"),)
    assert older.size(older.message("new_msgs/Outer")).fields == 2


def test_type_keeps_nested_types_of_other_clients() -> None:
    definitions = Keeper()
    definitions.bring("msg", "new_msgs/Point", "int32 x", "/first")
    outer = definitions.bring("msg", "new_msgs/Outer", "Point[] points", "/second")
    definitions.drop("msg", "new_msgs/Point", "/first")
    assert definitions.names() == ["new_msgs/Outer", "new_msgs/Point"]
    assert definitions.message("new_msgs/Point") is outer.message("new_msgs/Point")
    definitions.drop("msg", "new_msgs/Outer", "/second")
    assert definitions.names() == []


def test_nested_types_with_equal_fields_keep_the_names_of_their_own_text() -> None:
    """Equal md5s do not mean that the types in a type have equal names."""
    definitions = Keeper()
    inner = f"{SEPARATOR}\nMSG: new_msgs/Inner\n"
    definitions.learn("new_msgs/First", f"Inner i\n{inner}Point p\n{POINT}")
    other = f"{SEPARATOR}\nMSG: new_msgs/Other\nint32 x\n"
    second = definitions.bring("msg", "new_msgs/Second", f"Inner i\n{inner}Other p\n{other}")
    assert definitions.message("new_msgs/Inner").fields[0].type == "new_msgs/Point"
    definitions.drop("msg", "new_msgs/First")
    assert second.message("new_msgs/Inner").fields[0].type == "new_msgs/Other"
    assert definitions.message("new_msgs/Other").fields == (Field("x", "int32"),)


def test_standard_types_are_not_added() -> None:
    definitions = Keeper()
    assert definitions.read("msg", "std_msgs/Int32", "int32 data", "/client") is None
    nested = f"std_msgs/Int32 x\n{SEPARATOR}\nMSG: std_msgs/Int32\nint32 data"
    definitions.learn("new_msgs/Mine", nested)
    assert definitions.names() == ["new_msgs/Mine"]
    assert definitions.drop("msg", "new_msgs/Mine")
    assert definitions.message("std_msgs/Int32") is definitions.interfaces.message("std_msgs/Int32")


def test_each_client_has_its_own_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    definitions = Keeper()
    limit(monkeypatch, types=2)
    limit(monkeypatch, "OF_ALL", types=3)
    for name in ("One", "Two"):
        definitions.bring("msg", f"new_msgs/{name}", "int32 x", "/greedy")
    with pytest.raises(DefinitionLimit, match=r"from /greedy to add new_msgs/More \(limit is 2\)"):
        definitions.bring("msg", "new_msgs/More", "int32 x", "/greedy")
    definitions.bring("msg", "new_msgs/One", "int32 x", "/other")
    definitions.bring("msg", "new_msgs/Three", "int32 x", "/other")
    with pytest.raises(DefinitionLimit, match=r"from all clients to add .*limit is 3"):
        definitions.bring("msg", "new_msgs/Four", "int32 x", "/third")
    definitions.drop("msg", "new_msgs/Two", "/greedy")
    definitions.bring("msg", "new_msgs/Four", "int32 x", "/third")


def test_limits_count_characters(monkeypatch: pytest.MonkeyPatch) -> None:
    definitions = Keeper()
    limit(monkeypatch, characters=20)
    definitions.learn("new_msgs/One", "int32 x # one")
    with pytest.raises(DefinitionLimit, match="characters in definitions from /client"):
        definitions.learn("new_msgs/Two", "int32 x # two")
    definitions.drop("msg", "new_msgs/One")
    definitions.learn("new_msgs/Two", "int32 x # two")


def test_type_in_several_definitions_counts_once(monkeypatch: pytest.MonkeyPatch) -> None:
    definitions = Keeper()
    limit(monkeypatch, types=3, fields=5)
    for name in ("One", "Two"):
        definitions.learn(f"new_msgs/{name}", f"Point point\n{POINT}")
    definitions.drop("msg", "new_msgs/One")
    definitions.learn("new_msgs/Three", f"Point point\n{POINT}")


def test_definition_of_a_type_does_not_concern_its_package() -> None:
    interfaces = Keeper()
    interfaces.learn("new_msgs/Mine", "int32 x")
    with pytest.raises(UnknownPackage):
        interfaces.message("new_msgs/Mien")
    with pytest.raises(UnknownType, match="did you mean std_msgs/String"):
        interfaces.message("std_msgs/Sting")


def test_every_standard_type_may_be_repeated() -> None:
    interfaces, same = Interfaces(), Keeper()
    for package in interfaces.packages():
        for name in interfaces.messages(package):
            assert same.learn(name, interfaces.full_text(name)) == interfaces.message(name)


TEXTS: list[tuple[Kind, str, str, str]] = [
    ("msg", "std_msgs/Int32", "int32 data", "int64 data"),
    ("msg", "new_msgs/Mine", "int32 x", "int64 x"),
    ("msg", "new_msgs/Outer", f"Point p\n{POINT}", f"Point p\n{POINT}int32 y\n"),
    ("srv", "std_srvs/SetBool", "bool data\n---\nbool success\nstring message", "bool data\n---"),
    # All fields of both sides together are the same.
    ("srv", "new_msgs/Ask", "int8 x\n---\nint8 y", "int8 x\nint8 y\n---"),
    ("action", "new_msgs/Go", "int8 x\n---\n---", "int8 y\n---\n---"),
    ("action", "new_msgs/Go", f"Point x\n---\n---\n{POINT}", f"Point x\n---\n---\n{POINT}int8 y"),
]


@pytest.mark.parametrize(("kind", "name", "first", "second"), TEXTS)
def test_types_of_one_name_with_other_fields_are_different_types(
    kind: Kind, name: str, first: str, second: str
) -> None:
    definitions = Keeper()
    brought = [
        definitions.bring(kind, name, first, "/first"),
        definitions.bring(kind, name, second, "/second"),
        definitions.bring(kind, name, second + "\n# The same.", "/third"),
    ]
    md5s = [each.md5_of(kind, name) for each in brought]
    assert md5s[0] != md5s[1]
    assert brought[1] is brought[2]
    # The name alone stands for the first one, and an md5 for its own.
    assert definitions.known(kind, name) is brought[0]
    assert definitions.known_to("/client", kind, name, md5s[1]) is brought[1]
    assert not definitions.release(brought[1], ("/second", kind, name))  # type: ignore[arg-type]
    assert definitions.release(brought[1], ("/third", kind, name))  # type: ignore[arg-type]
    assert definitions.find_for("/client", kind, name, md5s[1]) is None
    assert definitions.known(kind, name) is brought[0]
    definitions.drop(kind, name, "/first")
    assert definitions.names() == []


def test_type_of_the_folders_in_which_a_nested_type_has_other_fields_is_another_one() -> None:
    definitions = Keeper()
    point = f"{SEPARATOR}\nMSG: geometry_msgs/Point\nint8 x"
    brought = definitions.bring("msg", "new_msgs/Mine", f"geometry_msgs/Pose pose\n{point}")
    assert definitions.names() == ["geometry_msgs/Point", "geometry_msgs/Pose", "new_msgs/Mine"]
    assert len(brought.message("geometry_msgs/Point").fields) == 1
    assert len(definitions.message("geometry_msgs/Point").fields) == 3


def test_definitions_of_one_name_count_each(monkeypatch: pytest.MonkeyPatch) -> None:
    limit(monkeypatch, types=2)
    definitions = Keeper()
    definitions.learn("new_msgs/Mine", "int8 x")
    definitions.bring("msg", "new_msgs/Mine", "int16 x")
    with pytest.raises(DefinitionLimit, match="limit is 2"):
        definitions.bring("msg", "new_msgs/Mine", "int32 x")


def test_types_are_hidden_with_their_holders() -> None:
    interfaces = Interfaces()
    definitions = ClientDefinitions(interfaces, lambda client, holder: holder == client)
    for client, text in (("/first", "int8 x"), ("/second", "int16 x")):
        definition = definitions.read("msg", "new_msgs/Mine", text, client)
        assert definition is not None
        definitions.hold(definition, client)
    found = [definitions.find_for(each, "msg", "new_msgs/Mine") for each in ("/first", "/second")]
    assert [each and each.text for each in found] == ["int8 x", "int16 x"]
    assert definitions.find_for("/third", "msg", "new_msgs/Mine") is None
    listed = [len(definitions.all_types(each)) for each in ("/first", "/second", "/third")]
    assert listed == [listed[2] + 1, listed[2] + 1, listed[2]]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (f"Inner inner\n{SEPARATOR}\nMSG: new_msgs/Inner\nint32", "line 4: expected a field"),
        (f"Inner inner\n{SEPARATOR}\nMSG: new_msgs/Inner\nOuter o", "contains itself"),
        (f"Inner i\nNo no\n{SEPARATOR}\nMSG: new_msgs/Inner\nint8 x", "unknown type (No|Ours)"),
    ],
)
def test_invalid_definition_adds_nothing(text: str, fault: str) -> None:
    interfaces = Keeper()
    with pytest.raises(DefinitionError, match=fault):
        interfaces.learn("new_msgs/Outer", text)
    assert interfaces.names() == []


def test_size_of_client_definitions_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    limit(monkeypatch, types=1)
    interfaces = Keeper()
    with pytest.raises(InterfaceError, match="limit is 262144 characters"):
        interfaces.learn("new_msgs/Long", "#" * 300_000)
    interfaces.learn("new_msgs/One", "int32 x")
    interfaces.learn("new_msgs/One", "int32 x # once more")
    with pytest.raises(InterfaceError, match="to add new_msgs/Two "):
        interfaces.learn("new_msgs/Two", "int32 x")


def test_client_may_define_a_service() -> None:
    interfaces = Keeper()
    service = interfaces.learn_service("new_msgs/srv/Ask", f"Point at\n---\nPoint[] all\n{POINT}")
    assert service is interfaces.service("new_msgs/Ask")
    assert service.request.fields == (Field("at", "new_msgs/Point"),)
    assert interfaces.message("new_msgs/Point").fields == (Field("x", "int32"),)
    assert interfaces.names() == ["new_msgs/Ask", "new_msgs/Point"]


def test_client_may_define_an_action() -> None:
    interfaces = Keeper()
    action = interfaces.learn_action("new_msgs/action/Go", f"Point to\n---\n---\nPoint at\n{POINT}")
    assert interfaces.known("action", "new_msgs/Go").action("new_msgs/Go") is action
    assert action.goal.fields == (Field("to", "new_msgs/Point"),)
    assert interfaces.message("new_msgs/GoActionGoal").fields[2].type == "new_msgs/GoGoal"
    assert len(interfaces.names()) == 9


def test_service_may_be_defined_without_known_nested_types() -> None:
    interfaces = Keeper()
    interfaces.learn_service("new_msgs/Ask", "std_msgs/Header header\n---")
    interfaces.learn_service("std_srvs/Again", "---")
    assert interfaces.names() == ["new_msgs/Ask", "std_srvs/Again"]


def test_every_standard_service_and_action_may_be_repeated() -> None:
    interfaces, same = Interfaces(), Keeper()
    for package in interfaces.packages():
        for name in interfaces.services(package):
            known = interfaces.service(name)
            assert same.learn_service(name, interfaces.service_text(name)) == known
        for name in interfaces.actions(package):
            assert same.learn_action(name, interfaces.action_text(name)) == interfaces.action(name)


def test_definition_sent_by_a_node_is_complete(tmp_path: Path) -> None:
    package = tmp_path / "my_msgs"
    for name, text in {
        "msg/Outer.msg": "Inner[] inner\nHeader header",
        "msg/Inner.msg": "wstring<=5 text",
        "srv/Ask.srv": "Outer outer\n---\nInner inner",
        "action/Go.action": "Outer outer\n---\nInner inner\n---",
    }.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text, "utf-8")
    mine, hubs = Interfaces([tmp_path]), Keeper()
    brought = hubs.bring("msg", "my_msgs/Outer", mine.full_text("my_msgs/Outer"))
    assert brought.md5("my_msgs/Outer") == mine.md5("my_msgs/Outer")
    hubs = Keeper()
    brought = hubs.bring("srv", "my_msgs/Ask", mine.service_text("my_msgs/Ask"))
    assert brought.service_md5("my_msgs/Ask") == mine.service_md5("my_msgs/Ask")
    brought = hubs.bring("action", "my_msgs/Go", mine.action_text("my_msgs/Go"))
    assert brought.md5("my_msgs/GoAction") == mine.md5("my_msgs/GoAction")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("int32 x", "expected 1 line of ---, got 0"),
        ("int32 x\n---\nint32", "line 3: expected a field"),
        (f"Point p\nNo no\n---\n{POINT}", "unknown type (No|Ours)"),
        (f"---\nNo no\n{POINT}", "unknown type (No|Ours)"),
        (f"---\n{POINT}Ours ours", "unknown type (No|Ours)"),
    ],
)
def test_invalid_service_or_action_adds_nothing(text: str, fault: str) -> None:
    interfaces = Keeper()
    with pytest.raises(DefinitionError, match=fault):
        interfaces.learn_service("new_msgs/Ask", text)
    one_more = fault.replace("1 line", "2 lines").replace("got 0", "got 1").replace("e 3", "e 4")
    with pytest.raises(DefinitionError, match=one_more):
        interfaces.learn_action("new_msgs/Go", f"---\n{text}")
    assert interfaces.names() == []


def test_services_and_actions_count_towards_the_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    interfaces = Keeper()
    limit(monkeypatch, types=2)
    interfaces.learn_service("new_msgs/Ask", f"Point p\n---\n{POINT}")
    for _ in range(2):
        interfaces.learn_service("new_msgs/Ask", f"Point p\n---\n{POINT}")
        with pytest.raises(InterfaceError, match="to add new_msgs/Tell "):
            interfaces.learn_service("new_msgs/Tell", "---")
    limit(monkeypatch, types=9)
    with pytest.raises(InterfaceError, match="to add new_msgs/Go "):
        interfaces.learn_action("new_msgs/Go", "---\n---")
    assert interfaces.names() == ["new_msgs/Ask", "new_msgs/Point"]
    limit(monkeypatch, types=10)
    interfaces.forget_refusals("/client")
    for _ in range(2):
        interfaces.learn_action("new_msgs/Go", "---\n---")
    for learn in (interfaces.learn_service, interfaces.learn_action):
        with pytest.raises(InterfaceError, match="limit is 262144 characters"):
            learn("new_msgs/Long", "#" * 300_000)


@pytest.mark.parametrize("line", ["float64[65537] x", "Big[2] x", "Big x\nbool y"])
def test_long_fixed_arrays_of_clients_are_refused(line: str) -> None:
    interfaces = Keeper()
    big = f"{SEPARATOR}\nMSG: new_msgs/Big\nuint8[65536] data"
    with pytest.raises(InterfaceError, match=r"new_msgs/\w+ has \d+ values .* 65536$"):
        interfaces.learn("new_msgs/Long", f"{line}\n{big}")
    with pytest.raises(InterfaceError, match=r"65536$"):
        interfaces.learn_service("new_msgs/Ask", f"---\n{line}\n{big}")
    with pytest.raises(InterfaceError, match=r"65536$"):
        interfaces.learn_action("new_msgs/Go", f"---\n---\n{line}\n{big}")
    assert interfaces.names() == []
    interfaces.learn("new_msgs/Fits", f"Big[] x\n{big}")


def test_types_in_folders_may_have_longer_fixed_arrays(tmp_path: Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Long.msg").write_text("uint8[4000000] x")
    interfaces = Keeper([tmp_path])
    assert interfaces.learn("my_msgs/Long", "uint8[4000000] x").fields[0].array
    assert interfaces.names() == []


def test_number_of_fields_of_client_definitions_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    limit(monkeypatch, fields=10)
    interfaces = Keeper()
    interfaces.learn("new_msgs/Three", "int8 x\nint8 Y=1\nint8 z")
    interfaces.learn("new_msgs/Four", "Three three\nint8 x")
    with pytest.raises(InterfaceError, match=r"fields and constants .*limit is 10"):
        interfaces.learn("new_msgs/More", "Four four")
    with pytest.raises(InterfaceError, match="to add new_msgs/Ask "):
        interfaces.learn_service("new_msgs/Ask", "Four four\n---")
    with pytest.raises(InterfaceError, match="to add new_msgs/Go "):
        interfaces.learn_action("new_msgs/Go", "int8 x\n---\n---")
    interfaces.learn("new_msgs/Time", "time t")
    with pytest.raises(InterfaceError, match="to add new_msgs/One "):
        interfaces.learn("new_msgs/One", "int8 x")


def test_repeated_definition_is_not_parsed_again(monkeypatch: pytest.MonkeyPatch) -> None:
    interfaces = Keeper()
    brought = {
        interfaces.learn: ("read_message", "int8 x"),
        interfaces.learn_service: ("read_service", "int8 x\n---"),
        interfaces.learn_action: ("read_action", "int8 x\n---\n---"),
    }
    for learn, (read, text) in brought.items():
        first = learn("new_msgs/Mine", text)
        with monkeypatch.context() as patch:
            patch.delattr(full_text, read)
            assert learn("new_msgs/Mine", text) == first


# Refused definitions.


@pytest.fixture
def texts(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The texts of messages that are parsed."""
    parsed: list[str] = []
    read = full_text.read_message

    def count(text: str, name: str) -> dict[str, MessageDefinition]:
        parsed.append(text)
        return read(text, name)

    monkeypatch.setattr(full_text, "read_message", count)
    return parsed


def refusal(definitions: Keeper, name: str, text: str, client: str = "/client") -> str:
    with pytest.raises(InterfaceError) as error:
        definitions.bring("msg", name, text, client)
    return str(error.value)


def test_refused_definition_is_read_once(texts: list[str]) -> None:
    definitions = Keeper()
    first = refusal(definitions, "new_msgs/Mine", "int32 1x")
    assert refusal(definitions, "new_msgs/Mine", "int32 1x") == first
    definitions.learn("new_msgs/Other", "int32 x")
    assert refusal(definitions, "new_msgs/Mine", "int32 1x") == first
    assert texts == ["int32 1x", "int32 x"]


def test_definition_without_room_is_read_again_when_there_is_room(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limit(monkeypatch, types=1)
    definitions = Keeper()
    definitions.learn("new_msgs/Mine", "int32 x")
    for _ in range(2):
        assert "limit is 1" in refusal(definitions, "new_msgs/Other", "int32 x")
    definitions.drop("msg", "new_msgs/Mine")
    definitions.learn("new_msgs/Other", "int32 x")


@pytest.mark.parametrize(("what", "most"), [("types", 2), ("characters", 22)])
def test_refused_definitions_count_like_kept_ones(
    monkeypatch: pytest.MonkeyPatch, texts: list[str], what: str, most: int
) -> None:
    limit(monkeypatch, "PER_CLIENT", **{what: most})
    definitions = Keeper()
    for number in range(5):
        refusal(definitions, "new_msgs/Mine", f"int32 {number}x")
    assert len(texts) == 2
    assert f"limit is {most}" in refusal(definitions, "new_msgs/Mine", "int32 x")
    refusal(definitions, "new_msgs/Mine", "int32 x!", "/other")
    definitions.forget_refusals("/client")
    definitions.learn("new_msgs/Mine", "int32 x")


def test_every_error_is_remembered_as_it_was() -> None:
    definitions = Keeper()
    for name, text in (
        ("new_msgs/Mine", "int32 1x"),
        ("new_msgs/Mine", "new_msgs/Unknown x"),
        ("std_msgs/Mine", "std_msgs/Unknown x"),
        ("new_msgs/Mine", "int32[100000] x"),
    ):
        found = []
        for _ in range(2):
            with pytest.raises(InterfaceError) as error:
                definitions.bring("msg", name, text)
            found.append((type(error.value), str(error.value), vars(error.value)))
        assert found[0] == found[1]


def test_remembered_error_keeps_nothing_of_what_was_read() -> None:
    definitions = Keeper()
    for _ in range(2):
        refusal(definitions, "new_msgs/Mine", "int32 1x")
    [refusals] = definitions._refusals.values()
    [found] = refusals._refusals.values()
    assert found.error.__traceback__ is None
    assert found.error.__context__ is None


def test_refused_definitions_of_all_clients_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    limit(monkeypatch, "OF_ALL", types=3)
    definitions = Keeper()
    for number in range(10):
        refusal(definitions, "new_msgs/Mine", f"int32 {number}x", f"/client_{number}")
        assert sum(map(len, definitions._refusals.values())) <= 3
