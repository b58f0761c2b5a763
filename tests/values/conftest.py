"""Tools run in this process, and the real hub that they meet, in a thread of its own."""

from hub_in_thread import client as client
from hub_in_thread import hub as hub
from hub_in_thread import publish as publish
from hub_in_thread import run as run
from running_programs import start as start
