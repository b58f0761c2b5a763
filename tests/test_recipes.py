"""The programs, the workflow and the lines of docs/recipes.md."""

from __future__ import annotations

import asyncio
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

import fibws
from fibws.hub import Settings
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "recipes.md").read_text("utf-8")


def block(heading: str, language: str) -> str:
    """Return the code of a recipe."""
    _, _, recipe = PAGE.partition(f"\n## {heading}\n")
    _, _, code = recipe.partition("\n## ")[0].partition(f"\n```{language}\n")
    assert code, heading
    return code.partition("```")[0]


def names_of(program: str) -> dict[str, Any]:
    """Return what a program defines."""
    names: dict[str, Any] = {"__name__": "recipe"}
    exec(compile(program, "recipe", "exec", dont_inherit=True), names)
    return names


async def test_node_in_a_fastapi_application(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fastapi")
    sent: list[dict[str, Any]] = []

    async def send(message: dict[str, Any]) -> None:
        sent.append(message)

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": b"", "more_body": False}

    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        app = names_of(block("FastAPI", "python"))["app"]
        async with app.router.lifespan_context(app):
            scope = {"type": "http", "method": "POST", "path": "/say/hello", "headers": []}
            await app({**scope, "query_string": b"", "raw_path": b"/say/hello"}, receive, send)
            assert (await node.wait_for_message("chatter", String)).data == "hello"
    assert sent[0]["status"] == 200


async def test_node_in_an_aiohttp_application(monkeypatch: pytest.MonkeyPatch) -> None:
    web = pytest.importorskip("aiohttp.web")
    async with HubServer(Settings(port=0)) as hub, fibws.Node("test", hub=hub.url) as node:
        monkeypatch.setenv("FIBWS_HUB", hub.url)
        runner = web.AppRunner(names_of(block("aiohttp", "python"))["app"])
        await runner.setup()
        site = web.TCPSite(runner, "127.0.0.1", 0)
        await site.start()
        host, port = runner.addresses[0]
        reader, writer = await asyncio.open_connection(host, port)
        writer.write(b"POST /say/hello HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n")
        assert b" 200 " in await reader.readline()
        assert (await node.wait_for_message("chatter", String)).data == "hello"
        writer.close()
        await runner.cleanup()


def test_workflow_is_valid(tmp_path: Path) -> None:
    workflow = tmp_path / "recipe.yml"
    workflow.write_text(block("A hub in a CI job", "yaml"))
    for schema in ("vendor.github-workflows", "custom.github-workflows-require-timeout"):
        command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", schema]
        done = subprocess.run([*command, str(workflow)], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.long
def test_steps_of_the_workflow_run(tmp_path: Path) -> None:
    workflow = yaml.safe_load(block("A hub in a CI job", "yaml"))
    lines = [step["run"] for step in workflow["jobs"]["tests"]["steps"] if "run" in step]
    install, start, publish = lines
    assert install.startswith("python -m pip install ")
    script = f"trap 'kill %1; wait' EXIT\n{start}\nexport $(cat \"$GITHUB_ENV\")\n{publish}\n"
    (tmp_path / "fibws").write_text(f'#!/bin/sh\nexec "{sys.executable}" -P -m fibws "$@"\n')
    (tmp_path / "fibws").chmod(0o755)
    path = os.pathsep.join([str(tmp_path), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "GITHUB_ENV": str(tmp_path / "env")}
    words = ["bash", "-ec", script]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_lines_that_reconnect_roslib_are_tested_with_it() -> None:
    scenario = (ROOT / "tests" / "clients" / "scenarios" / "reconnection.mjs").read_text("utf-8")
    section = PAGE.partition("## roslib that reconnects")[2].partition("\n## ")[0]
    lines = "".join(re.findall(r"```js\n(.*?)```", section, re.DOTALL)).splitlines()
    assert len(lines) >= 4
    for line in lines:
        assert line.partition(" //")[0] in scenario
