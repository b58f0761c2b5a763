"""``fibws msg``: the types of messages, as rosmsg has them."""

from fibws.cli.types.commands import group

command = group("msg")
