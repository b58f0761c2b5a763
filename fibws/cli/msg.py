"""``fibws msg``: message types, as rosmsg."""

from fibws.cli.types import group

command = group("msg")
