"""The image and the containers of Compose, as far as they can be tested without Docker."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

ROOT = Path(__file__).parents[1]
WITH_NODE_NAME = ROOT / "docker" / "with-node-name"
COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text("utf-8"))


@pytest.fixture
def programs(tmp_path: Path) -> Path:
    """A folder of programs that answer as in a container: /etc/hosts has its id, DNS its name."""
    write(tmp_path / "hostname", 'test "$*" = -i && echo 172.18.0.4 172.19.0.2')
    return tmp_path


def write(program: Path, text: str) -> None:
    program.write_text(f"#!/bin/sh\n{text}\n")
    program.chmod(0o755)


def run(programs: Path, *arguments: str) -> str:
    path = f"{programs}:{os.environ['PATH']}"
    ran = subprocess.run(
        [WITH_NODE_NAME, *arguments],
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    return ran.stdout.strip()


@pytest.mark.parametrize(
    ("service", "found", "name"),
    [
        ("listener", "fibws-listener-3.fibws_default", "listener_3"),
        ("listener", "my-listener-2-listener-13.my-listener-2_default", "listener_13"),
        ("arm-left", "lab-arm-left-1.lab_default", "arm_left_1"),
        ("listener", "fibws_listener_3", "listener_3"),
    ],
)
def test_node_is_named_after_its_service_and_number(
    programs: Path, service: str, found: str, name: str
) -> None:
    answer = f'test "$*" = "-s dns hosts 172.19.0.2" && echo "172.19.0.2      {found}"'
    write(programs / "getent", answer)
    assert run(programs, service, "echo", "a  b") == f"a  b __name:={name}"


@pytest.mark.parametrize("answer", ["exit 2", "echo 172.18.0.4 great-einstein"])
def test_node_keeps_its_name_outside_compose(programs: Path, answer: str) -> None:
    write(programs / "getent", answer)
    assert run(programs, "listener", "echo", "a") == "a"


def test_getent_asks_dns_alone() -> None:
    """The real getent knows the option; 2 means that it found nothing."""
    asked = subprocess.run(["getent", "-s", "dns", "hosts", "127.0.0.1"], capture_output=True)
    assert asked.returncode in (0, 2), asked.stderr


def test_services_of_compose_run_programs_of_the_image() -> None:
    for name, service in COMPOSE["services"].items():
        words = shlex.split(service["command"])
        if name != "hub":
            assert words[:2] == [WITH_NODE_NAME.name, name]
            words = words[2:]
        assert words[:2] == ["python", "-m"]
        assert (ROOT / words[2].replace(".", "/")).with_suffix(".py").exists() or name == "hub"


def test_generated_files_are_not_sent_to_docker() -> None:
    sent = (ROOT / ".dockerignore").read_text("utf-8").splitlines()
    for pattern in (ROOT / ".gitignore").read_text("utf-8").splitlines():
        if pattern.startswith("/fibws/"):
            assert pattern.strip("/").replace("[!", "[^") in sent


def test_files_that_the_image_copies_are_sent_to_docker() -> None:
    sent = (ROOT / ".dockerignore").read_text("utf-8").splitlines()
    copied = re.findall(r"^COPY (?!--from)(.*) \S+$", (ROOT / "Dockerfile").read_text(), re.M)
    for path in " ".join(copied).split():
        if path != ".":
            assert (ROOT / path).exists()
            assert f"!{path.partition('/')[0]}" in sent
