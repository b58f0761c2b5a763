"""What a name was perhaps meant to be."""

from __future__ import annotations

from fibws.cli.hint import hint, nearest


def test_the_nearest_name_is_the_one_that_was_perhaps_meant() -> None:
    assert nearest("/chater", ["/chatter", "/charter_flight"]) == "/chatter"
    assert nearest("/chater", iter(["/rosout"])) is None


def test_an_error_can_end_with_it() -> None:
    assert hint("/chater", ["/chatter"]) == "; did you mean /chatter?"
    assert hint("/chater", []) == ""
