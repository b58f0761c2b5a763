"""Caches: responses are made once for each revision of the graph, texts of types once."""

from __future__ import annotations

import gc
from collections.abc import Callable, Hashable

import pytest

from fibws.access.rights import Principal, Right, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.graph.graph import Graph
from fibws.hub.graph.policy import AllowAll
from fibws.hub.rosapi.cache import (
    FRESH_FOR,
    LARGE,
    MOST_VIEWS,
    OVERHEAD,
    Make,
    ResponseCache,
    TextCache,
    Views,
)
from fibws.interfaces import Interfaces
from fibws.interfaces.catalogue import Definitions, TextDefinitions

from ..fakes import INT32, FakeHub


class HideAll(AllowAll):
    """A policy that lets nodes list nothing."""

    allows_all = False

    def may(self, node: str, right: Right, name: str) -> bool:
        return not name


# Responses.


@pytest.mark.parametrize("get", [ResponseCache.get, ResponseCache.get_lately])
def test_response_is_made_once_for_each_revision(
    get: Callable[[ResponseCache, Make, str], bytes],
) -> None:
    hub = FakeHub()
    made: list[str] = []

    def make(caller: str) -> bytes:
        made.append(caller)
        return b"%d" % len(made)

    cache = ResponseCache(hub.graph)
    assert [get(cache, make, "/a"), get(cache, make, "/b")] == [b"1", b"1"]
    client = hub.client()
    assert [get(cache, make, "/a"), get(cache, make, "/b")] == [b"2", b"2"]
    client.send("advertise", "/fib", type=INT32)
    assert get(cache, make, "/a") == b"3"


def test_different_responses_are_cached_separately() -> None:
    cache = ResponseCache(FakeHub().graph)
    assert [cache.get(make, "/a") for make in (_one, _two, _one)] == [b"1", b"2", b"1"]


@pytest.mark.parametrize(
    "get", [ResponseCache.get, ResponseCache.get_lately, ResponseCache.get_recent]
)
def test_nodes_share_no_responses_if_a_policy_gives_them_other_views(
    get: Callable[[ResponseCache, Make, str], bytes],
) -> None:
    cache = ResponseCache(FakeHub(policy=HideAll()).graph)
    made: list[str] = []

    def make(caller: str) -> bytes:
        made.append(caller)
        return caller.encode() * LARGE

    for _ in range(3):
        assert [get(cache, make, node)[:2] for node in ("/a", "/b")] == [b"/a", b"/b"]
    assert made == ["/a", "/b"]


def principal(name: str, **allow: list[str]) -> Principal:
    return Principal(name, Rights(allow))  # type: ignore[arg-type]


def views(policy: AccessPolicy, *principals: Principal) -> list[Hashable]:
    """Return the views of nodes of some principals."""
    for number, each in enumerate(principals):
        policy.enter(f"/{number}", each, is_chosen=False, is_taken=False)
    return [policy.view(f"/{number}") for number in range(len(principals))]


def test_nodes_of_one_principal_share_a_view_until_its_rights_change() -> None:
    one, same, changed, other = views(
        AccessPolicy(),
        principal("one", subscribe=["/a"]),
        principal("one", subscribe=["/a"]),
        principal("one", subscribe=["/b"]),
        principal("other", subscribe=["/a"]),
    )
    assert one == same
    assert len({one, changed, other}) == 3


def test_anonymous_nodes_have_views_of_their_own() -> None:
    anonymous = Principal("anonymous", Rights(), proof="anonymous")
    one, other = views(AccessPolicy(), anonymous, anonymous)
    assert one != other
    assert AccessPolicy().view("/rosapi") == "/rosapi"


def test_responses_of_many_views_are_bounded() -> None:
    cache = ResponseCache(FakeHub(policy=HideAll()).graph, max_bytes=3 * (OVERHEAD + 10))
    made: list[str] = []

    def make(caller: str) -> bytes:
        made.append(caller)
        return bytes(10)

    for node in ("/a", "/b", "/c", "/d", "/d", "/c", "/a"):
        cache.get(make, node)
    assert made == ["/a", "/b", "/c", "/d", "/a"]
    assert cache.get(lambda caller: bytes(100_000), "/e") == bytes(100_000)
    assert len(cache._responses) == 1


def test_view_is_made_once_for_each_revision() -> None:
    hub = FakeHub(policy=HideAll())
    made: list[str] = []
    seen = Views(hub.graph, made.append)
    for _ in range(2):
        seen.get("/a")
        seen.get("/b")
    hub.client()
    seen.get("/a")
    assert made == ["/a", "/b", "/a"]


def test_views_that_were_used_last_are_kept() -> None:
    made: list[str] = []
    seen = Views(FakeHub(policy=HideAll()).graph, made.append)
    for number in range(2 * MOST_VIEWS):
        seen.get("/a")
        seen.get(f"/{number}")
    assert made.count("/a") == 1
    assert len(seen._views) == MOST_VIEWS


class Response:
    """A response of some size about a graph, whose clock the test sets."""

    def __init__(self, size: int) -> None:
        self.now = 0
        self.made = 0
        self.size = size
        self.graph = Graph(Interfaces(), lambda: self.now)
        self.cache = ResponseCache(self.graph)

    def make(self, caller: str) -> bytes:
        self.made += 1
        return b" " * self.size


def test_large_response_is_reused_for_a_while_although_the_graph_changes() -> None:
    response = Response(LARGE)
    for now, made in ((0, 1), (LARGE * FRESH_FOR - 1, 1), (LARGE * FRESH_FOR, 2)):
        response.now = now
        response.graph.revision += 1
        response.cache.get_lately(response.make, "/a")
        assert response.made == made


def test_response_without_a_revision_is_always_of_the_newest() -> None:
    response = Response(LARGE)
    for made in (1, 2, 3):
        response.graph.revision += 1
        response.cache.get(response.make, "/a")
        assert response.made == made


def test_response_that_changes_without_the_graph_is_reused_only_if_it_is_large() -> None:
    for size, made in ((LARGE - 1, [1, 2, 3]), (LARGE, [1, 1, 2])):
        response = Response(size)
        for now, times in zip((0, 1, LARGE * FRESH_FOR), made, strict=True):
            response.now = now
            response.cache.get_recent(response.make, "/a")
            assert response.made == times


def test_clock_that_is_set_back_does_not_keep_a_response_for_long() -> None:
    response = Response(LARGE)
    for now in (10**18, 0):
        response.now = now
        response.cache.get_recent(response.make, "/a")
    assert response.made == 2


def _one(caller: str) -> bytes:
    return b"1"


def _two(caller: str) -> bytes:
    return b"2"


# Texts of types.


class MakeText:
    """Makes texts of ten bytes, and records their names."""

    def __init__(self) -> None:
        self.made: list[str] = []

    def __call__(self, definitions: Definitions, name: str) -> bytes:
        self.made.append(name)
        if name == "wrong":
            raise LookupError(name)
        return name.encode().ljust(10)


KNOWN = Interfaces()


def test_text_is_made_once() -> None:
    make = MakeText()
    texts = TextCache(make)
    assert [texts.get(KNOWN, name) for name in "aba"] == [
        b"a         ",
        b"b         ",
        b"a         ",
    ]
    assert make.made == ["a", "b"]


def test_error_is_not_cached() -> None:
    make = MakeText()
    texts = TextCache(make)
    for _ in range(2):
        with pytest.raises(LookupError):
            texts.get(KNOWN, "wrong")
    assert make.made == ["wrong", "wrong"]


def test_all_texts_are_dropped_when_they_exceed_the_limit() -> None:
    make = MakeText()
    texts = TextCache(make, max_bytes=30)
    for name in "abcabc":
        texts.get(KNOWN, name)
    assert make.made == ["a", "b", "c"]
    for name in "dad":
        texts.get(KNOWN, name)
    assert make.made == ["a", "b", "c", "d", "a"]


def test_texts_of_forgotten_definitions_are_made_again_and_take_no_room() -> None:
    make = MakeText()
    texts = TextCache(make, max_bytes=30)
    mine, same = TextDefinitions("a/A", "int8 x"), TextDefinitions("a/A", "int8 x")
    for definitions in (mine, mine, same):
        texts.get(definitions, "a/A")
    assert make.made == ["a/A", "a/A"]
    del mine, definitions
    gc.collect()
    assert len(texts._texts) == 1
