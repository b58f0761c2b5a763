"""``fibws msg``: the types of messages, as rosmsg has them."""

from fibws.cli.types import group

command = group("msg")
