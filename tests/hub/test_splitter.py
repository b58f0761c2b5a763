"""The bytes of WebSocket frames are split where the frames are."""

from __future__ import annotations

import pytest
from websockets.frames import Frame, Opcode

from fibws.hub.splitter import Splitter

TEXTS = [b"", b"a", b"x" * 125, b"y" * 126, b"z" * 300]


def masked(opcode: Opcode, data: bytes, *, fin: bool = True) -> bytes:
    return Frame(opcode, data, fin).serialize(mask=True)


def text(data: bytes) -> bytes:
    return masked(Opcode.TEXT, data)


class Split:
    """A splitter, and what came out of it: texts as they are, other bytes one behind another."""

    def __init__(self, *, max_size: int = 1000) -> None:
        self.came: list[tuple[str, bytes]] = []
        self.splitter = Splitter(self._text, self._other, max_size=max_size)

    def _text(self, data: bytes) -> None:
        self.came.append(("text", data))

    def _other(self, data: bytes) -> None:
        if self.came and self.came[-1][0] == "other":
            data = self.came.pop()[1] + data
        self.came.append(("other", data))

    def receive(self, data: bytes) -> list[tuple[str, bytes]]:
        self.splitter.receive(data)
        return self.came


def texts(*datas: bytes) -> list[tuple[str, bytes]]:
    return [("text", data) for data in datas]


def test_texts_come_out_unmasked_and_one_by_one() -> None:
    assert Split().receive(b"".join(map(text, TEXTS))) == texts(*TEXTS)


def test_a_large_text_comes_out_whole() -> None:
    large = b"large" * 20_000
    assert Split(max_size=100_000).receive(text(large)) == texts(large)


PING = masked(Opcode.PING, b"are you there?")
BINARY = masked(Opcode.BINARY, b"{}" * 200)
MIXED = text(b"one") + PING + BINARY + text(b"two" * 50) + text(b"") + PING
CAME = [
    ("text", b"one"),
    ("other", PING + BINARY),
    ("text", b"two" * 50),
    ("text", b""),
    ("other", PING),
]


def test_other_frames_are_handed_on_between_the_texts() -> None:
    assert Split().receive(MIXED) == CAME


@pytest.mark.parametrize("cut", range(len(MIXED) + 1))
def test_a_cut_anywhere_makes_no_difference(cut: int) -> None:
    split = Split()
    split.receive(MIXED[:cut])
    assert split.receive(MIXED[cut:]) == CAME


@pytest.mark.parametrize("size", [1, 2, 3, 5, 7, 13, 100])
def test_pieces_of_any_size_make_no_difference(size: int) -> None:
    split = Split()
    for start in range(0, len(MIXED), size):
        split.receive(MIXED[start : start + size])
    assert split.came == CAME
    assert split.splitter.missing == 0


def test_a_large_text_may_come_byte_by_byte() -> None:
    split = Split(max_size=70_000)
    for byte in text(b"x" * 66_000):
        split.receive(bytes([byte]))
    assert split.came == texts(b"x" * 66_000)


@pytest.mark.parametrize("size", [1, 126, 65536])
def test_it_says_how_many_bytes_are_missing(size: int) -> None:
    frame = text(b"x" * size)
    split = Split(max_size=size)
    split.receive(frame[:-1])
    assert split.splitter.missing == 1
    split.receive(frame[-1:])
    assert split.splitter.missing == 0


def test_an_other_frame_is_handed_on_before_it_is_whole() -> None:
    assert Split().receive(BINARY[:20]) == [("other", BINARY[:20])]


def test_a_text_that_is_too_large_is_the_librarys_to_refuse() -> None:
    frame = text(b"x" * 1001)
    assert Split(max_size=1000).receive(frame[:10]) == [("other", frame[:10])]


FIRST = masked(Opcode.TEXT, b"one ", fin=False)


def test_a_fragmented_message_is_the_librarys_to_join() -> None:
    rest = masked(Opcode.CONT, b"message")
    assert Split().receive(FIRST + rest + text(b"two")) == [
        ("other", FIRST + rest),
        ("text", b"two"),
    ]


def test_a_text_within_a_fragmented_message_is_the_librarys_to_refuse() -> None:
    split = Split()
    split.receive(FIRST)
    split.splitter.fragmented = True
    wrong = text(b"wrong")
    assert split.receive(wrong) == [("other", FIRST + wrong)]


@pytest.mark.parametrize(
    "wrong",
    [
        Frame(Opcode.TEXT, b"not masked").serialize(mask=False),
        b"\xc1\x80abcd",
        b"\x83\x80abcd",
        b"\x8f\x80abcd",
        b"GET / HTTP/1.1\r\n\r\n",
    ],
    ids=["not masked", "reserved bit", "opcode 3", "opcode 15", "no WebSocket"],
)
def test_after_an_error_all_the_rest_is_the_librarys(wrong: bytes) -> None:
    split = Split()
    split.receive(text(b"good") + wrong + text(b"never read"))
    split.receive(text(b"nor this"))
    assert [kind for kind, _ in split.came] == ["text", "other"]
    assert split.came[1][1].startswith(wrong)
    assert len(split.came[1][1]) == len(wrong + text(b"never read") + text(b"nor this"))


def test_once_given_up_it_reads_no_more() -> None:
    split = Split()
    split.splitter.give_up()
    frame = text(b"x")
    assert split.receive(frame) == [("other", frame)]


def test_who_reads_a_text_may_give_up() -> None:
    others: list[bytes] = []
    splitter = Splitter(lambda _: splitter.give_up(), others.append, max_size=10)
    rest = text(b"two") + text(b"three")
    splitter.receive(text(b"one") + rest)
    assert others == [rest]


def test_what_is_left_at_the_end_is_the_librarys() -> None:
    split = Split()
    frame = text(b"never whole")
    split.receive(frame[:-1])
    split.splitter.end()
    assert split.came == [("other", frame[:-1])]


def test_nothing_may_be_left_at_the_end() -> None:
    split = Split()
    split.receive(text(b"whole"))
    split.splitter.end()
    assert split.came == texts(b"whole")
