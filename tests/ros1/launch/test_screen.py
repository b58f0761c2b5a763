"""What a person sees."""

from __future__ import annotations

from fibws.ros1.launch.screen import Screen


def test_each_line_has_its_process_before_it() -> None:
    seen: list[tuple[str, bool]] = []
    screen = Screen(lambda line, is_error: seen.append((line, is_error)))
    screen.say("hello", bold=True)
    screen.show("talker-1", "1")
    screen.show("talker-1", "2", is_error=True)
    screen.complain("no")
    assert seen == [
        ("hello", False),
        ("[talker-1] 1", False),
        ("[talker-1] 2", True),
        ("no", True),
    ]


def test_on_a_terminal_each_process_has_a_colour_of_its_own() -> None:
    seen: list[str] = []
    screen = Screen(lambda line, is_error: seen.append(line), colours=True)
    for process in ("a-1", "b-2", "a-1"):
        screen.show(process, "x")
    screen.say("bold", bold=True)
    screen.say("plain")
    screen.complain("red")
    assert seen[0] == seen[2] == "\x1b[36m[a-1]\x1b[0m x"
    assert seen[1] == "\x1b[33m[b-2]\x1b[0m x"
    assert seen[3:] == ["\x1b[1mbold\x1b[0m", "plain", "\x1b[31mred\x1b[0m"]
