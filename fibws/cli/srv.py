"""``fibws srv``: the types of services, as rossrv has them."""

from fibws.cli.types import group

command = group("srv")
