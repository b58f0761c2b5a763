"""``fibws srv``: service types, as rossrv."""

from fibws.cli.types import group

command = group("srv")
