"""Tools run in this process, and the real hub that they meet, in a thread of its own."""

import pytest
from hub_in_thread import client as client
from hub_in_thread import hub as hub
from hub_in_thread import publish as publish
from hub_in_thread import run as run
from running_programs import start as start


@pytest.fixture(autouse=True)
def called_by_no_alias(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forget the alias by which a test calls the tools in this process."""
    monkeypatch.setattr("fibws.command_names._called_alias", None)
