"""Putting the fragments of a text together."""

from __future__ import annotations

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.errors import OperationError
from fibws.protocol.fragments import PIECE_COST, Reassembly
from fibws.protocol.operations import Fragment

MANY = 1_000_000


def piece(num: int, data: str = "x", *, id_: str | int = "m", total: int = 3) -> Fragment:
    return Fragment(id=id_, data=data, num=num, total=total)


def test_text_is_returned_when_no_piece_is_missing() -> None:
    reassembly = Reassembly(max_size=MANY)
    assert [reassembly.add(piece(num, data), 0) for num, data in enumerate("abc")] == [
        None,
        None,
        "abc",
    ]


def test_text_may_be_a_single_piece() -> None:
    assert Reassembly(max_size=MANY).add(piece(0, "all", total=1), 0) == "all"


@pytest.mark.parametrize("order", [*permutations(range(3))])
def test_pieces_may_come_in_any_order(order: tuple[int, ...]) -> None:
    reassembly = Reassembly(max_size=MANY)
    assert [reassembly.add(piece(num, "abc"[num]), 0) for num in order][-1] == "abc"


def test_duplicate_piece_is_ignored() -> None:
    reassembly = Reassembly(max_size=MANY)
    for num, data in [(0, "a"), (0, "z"), (1, "b"), (1, "z")]:
        assert reassembly.add(piece(num, data), 0) is None
    assert reassembly.add(piece(2, "c"), 0) == "abc"


def test_several_messages_may_be_unfinished() -> None:
    reassembly = Reassembly(max_size=MANY)
    for id_ in ("m", 1, "1"):
        reassembly.add(piece(0, f"{id_!r}", id_=id_, total=2), 0)
    assert [reassembly.add(piece(1, "!", id_=id_, total=2), 0) for id_ in ("1", 1, "m")] == [
        "'1'!",
        "1!",
        "'m'!",
    ]


def test_id_may_be_reused() -> None:
    reassembly = Reassembly(max_size=MANY)
    assert [reassembly.add(piece(num % 2, str(num), total=2), 0) for num in range(4)] == [
        None,
        "01",
        None,
        "23",
    ]


@pytest.mark.parametrize(("num", "total"), [(-1, 2), (2, 2), (3, 2), (0, 0), (0, -1), (-1, -1)])
def test_piece_outside_the_message_is_refused(num: int, total: int) -> None:
    with pytest.raises(OperationError, match="num must be from 0 to total - 1"):
        Reassembly(max_size=MANY).add(piece(num, total=total), 0)


def test_message_is_dropped_when_its_total_changes() -> None:
    reassembly = Reassembly(max_size=MANY)
    reassembly.add(piece(0, total=2), 0)
    with pytest.raises(OperationError, match="changed from 2 to 3"):
        reassembly.add(piece(1, total=3), 0)
    assert reassembly.add(piece(1, total=2), 0) is None


def test_number_of_unfinished_messages_is_limited() -> None:
    reassembly = Reassembly(max_size=MANY, max_messages=2)
    reassembly.add(piece(0, id_=1), 0)
    reassembly.add(piece(0, id_=2), 0)
    with pytest.raises(OperationError, match=r"too many unfinished messages \(limit 2\)"):
        reassembly.add(piece(0, id_=3), 0)
    reassembly.add(piece(1, id_=1), 0)
    assert reassembly.add(piece(2, id_=1), 0) == "xxx"
    reassembly.add(piece(0, id_=3), 0)


def test_bytes_of_unfinished_messages_are_limited() -> None:
    reassembly = Reassembly(max_size=2000)
    reassembly.add(piece(0, "x" * 800, id_=1), 0)
    reassembly.add(piece(0, "x" * 800, id_=2), 0)
    with pytest.raises(OperationError, match=r"too many bytes in unfinished messages \(limit 2000"):
        reassembly.add(piece(1, "x" * 800, id_=2), 0)
    assert reassembly.add(piece(1, "x" * 800, id_=1), 0) is None


def test_finished_message_frees_its_bytes() -> None:
    reassembly = Reassembly(max_size=2000)
    for _ in range(10):
        reassembly.add(piece(0, "x" * 800, total=2), 0)
        assert reassembly.add(piece(1, "x" * 800, total=2), 0) == "x" * 1600


def test_duplicate_piece_takes_no_bytes() -> None:
    reassembly = Reassembly(max_size=2000)
    for _ in range(10):
        reassembly.add(piece(0, "x" * 800), 0)


def test_empty_pieces_count_towards_the_limit() -> None:
    reassembly = Reassembly(max_size=10 * PIECE_COST + 10)
    for num in range(10):
        reassembly.add(piece(num, "", total=MANY), 0)
    with pytest.raises(OperationError, match="too many bytes"):
        reassembly.add(piece(10, "", total=MANY), 0)


def test_long_ids_count_towards_the_limit() -> None:
    reassembly = Reassembly(max_size=2000)
    reassembly.add(piece(0, id_="x" * 1500), 0)
    with pytest.raises(OperationError):
        reassembly.add(piece(0, id_="y" * 1500), 0)


def test_characters_count_by_their_bytes() -> None:
    reassembly = Reassembly(max_size=2000)
    with pytest.raises(OperationError):
        reassembly.add(piece(0, "\N{ROBOT FACE}" * 1000), 0)


def test_unfinished_message_is_dropped_after_its_timeout() -> None:
    reassembly = Reassembly(max_size=MANY, max_messages=1, timeout=600)
    reassembly.add(piece(0, "old"), 0)
    with pytest.raises(OperationError):
        reassembly.add(piece(0, id_="other"), 600)
    assert reassembly.add(piece(0, id_="other", total=1), 601) == "x"
    assert reassembly.add(piece(1), 602) is None
    assert reassembly.add(piece(2), 602) is None
    assert reassembly.add(piece(0, "new"), 602) == "newxx"


def test_younger_message_is_kept() -> None:
    reassembly = Reassembly(max_size=MANY, timeout=600)
    reassembly.add(piece(0, id_="old", total=2), 0)
    reassembly.add(piece(0, id_="young", total=2), 400)
    assert reassembly.add(piece(1, id_="young", total=2), 700) == "xx"
    assert reassembly.add(piece(1, id_="old", total=2), 700) is None


@given(st.data())
def test_any_texts_are_restored_from_any_order_of_pieces(data: st.DataObject) -> None:
    texts = data.draw(st.lists(st.lists(st.text(max_size=3), min_size=1), min_size=1, max_size=4))
    pieces = data.draw(
        st.permutations(
            [
                piece(num, part, id_=id_, total=len(parts))
                for id_, parts in enumerate(texts)
                for num, part in enumerate(parts)
            ]
        )
    )
    reassembly = Reassembly(max_size=MANY)
    done = {each.id: text for each in pieces if (text := reassembly.add(each, 0)) is not None}
    assert done == {id_: "".join(parts) for id_, parts in enumerate(texts)}
