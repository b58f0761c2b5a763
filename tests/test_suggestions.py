"""What a name was perhaps meant to be."""

from __future__ import annotations

from fibws.suggestions import hint, hint_or_all, nearest


def test_the_nearest_name_is_the_one_that_was_perhaps_meant() -> None:
    assert nearest("/chater", ["/chatter", "/charter_flight"]) == "/chatter"
    assert nearest("/chater", iter(["/rosout"])) is None


def test_an_error_can_end_with_it() -> None:
    assert hint("/chater", ["/chatter"]) == "; did you mean /chatter?"
    assert hint("/chater", []) == ""


def test_an_error_can_end_with_all_that_there_is() -> None:
    assert hint_or_all("ag", ["arg", "node"]) == "; did you mean arg?"
    assert hint_or_all("qwertz", iter(["arg", "node"])) == "; known are arg, node"
    assert hint_or_all("qwertz", []) == ""
