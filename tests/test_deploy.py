"""The files in deploy/, checked by the programs that read them."""

from __future__ import annotations

import asyncio
import json
import os
import re
import shutil
import ssl
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
import yaml
from certificates import Authority
from certificates import authority as authority
from conftest import StartHub
from patience import PATIENCE
from prometheus_client.parser import text_string_to_metric_families
from running_programs import Start
from running_programs import start as start
from websockets.asyncio.client import connect
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request
from websockets.typing import Origin

from fibws.access.token_file import digest_of
from fibws.hub import Settings
from fibws.hub.__main__ import environment_settings
from fibws.hub.ros1.server import default_state_file
from fibws.hub.server import HubServer
from fibws.hub.tls import self_signed
from fibws.protocol.websocket import LIMITED, UNAUTHENTICATED

ROOT = Path(__file__).parents[1]
DEPLOY = ROOT / "deploy"
OPERATIONS = (ROOT / "docs" / "operations.md").read_text("utf-8")
COMPOSE: dict[str, Any] = yaml.safe_load((DEPLOY / "compose" / "compose.yaml").read_text("utf-8"))
KUBERNETES: dict[str, dict[str, Any]] = {
    each["kind"]: each
    for each in yaml.safe_load_all((DEPLOY / "kubernetes" / "fibws.yaml").read_text("utf-8"))
}
UNIT = DEPLOY / "fibws-hub.service"
COMPOSE_FILES = {
    path.relative_to(ROOT).as_posix(): yaml.safe_load(path.read_text("utf-8"))
    for path in (DEPLOY / "compose" / "compose.yaml", ROOT / "docker-compose.yml")
}
ALERTS = DEPLOY / "compose" / "prometheus" / "alerts.yml"
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SITE = "localhost:9443"
"""What the tests call the site of Compose."""
SHELL_VARIABLE = re.compile(r"\$\{\w+:-([^}]+)\}")


def needs(program: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(shutil.which(program) is None, reason=f"needs {program}")


def checked(*command: str, **environment: str) -> str:
    """Run a program that must succeed; return all that it prints."""
    ran = subprocess.run(
        command,
        capture_output=True,
        text=True,
        env={"PATH": "/usr/bin:/bin:/usr/sbin:/usr/local/bin", **environment},
    )
    output = ran.stdout + ran.stderr
    assert ran.returncode == 0, output
    return output


def strings_in(value: object, kind: str) -> Iterator[str]:
    """Yield all strings of some kind in a document."""
    if isinstance(value, Mapping):
        for key, each in value.items():
            if key == kind:
                yield str(each)
            yield from strings_in(each, kind)
    elif isinstance(value, list):
        for each in value:
            yield from strings_in(each, kind)


class TestMounts:
    """Programs that replace a file make another one; a mount of the former one keeps that."""

    @pytest.mark.parametrize("name", COMPOSE_FILES)
    def test_compose_mounts_folders_and_volumes(self, name: str) -> None:
        document = COMPOSE_FILES[name]
        assert not {"secrets", "configs"} & document.keys(), "these mount single files"
        for service in document["services"].values():
            for mount in service.get("volumes", ()):
                source = mount.partition(":")[0]
                if source.startswith("."):
                    assert (ROOT / name).parent.joinpath(source).is_dir(), mount
                else:
                    assert source in document["volumes"], mount

    def test_kubernetes_mounts_whole_volumes(self) -> None:
        assert not list(strings_in(list(KUBERNETES.values()), "subPath"))

    def test_systemd_passes_no_copies(self) -> None:
        """systemd copies credentials when the service starts, and never again."""
        text = UNIT.read_text("utf-8")
        assert not re.search(r"^(LoadCredential|SetCredential|Bind\w*Paths)", text, re.M)

    @pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
    def test_pages_mount_no_files(self, page: Path) -> None:
        code = "".join(re.findall(r"^```\w*\n(.*?)^```$", page.read_text("utf-8"), re.M | re.S))
        assert not re.search(r"(-v|--volume|source=)[ =]?\S+\.(toml|pem|key|token|json)\b", code)
        assert not re.search("subPath|LoadCredential", code)


class TestSystemd:
    def test_page_shows_the_unit_file(self) -> None:
        assert f"```ini\n{UNIT.read_text('utf-8')}```" in OPERATIONS

    @needs("systemd-analyze")
    def test_unit_is_hardened(self) -> None:
        output = checked("systemd-analyze", "security", "--offline=true", "--no-pager", str(UNIT))
        found = re.search(r"exposure level for \S+: ([\d.]+)", output)
        assert found is not None and float(found[1]) < 2.0, output

    def test_hub_keeps_its_files_where_the_unit_lets_it(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (state,) = re.findall(r"^StateDirectory=(.*)$", UNIT.read_text("utf-8"), re.M)
        # What systemd sets for the service of a dynamic user; ProtectSystem= forbids the rest.
        monkeypatch.setenv("HOME", "/")
        monkeypatch.delenv("XDG_STATE_HOME", raising=False)
        monkeypatch.setenv("STATE_DIRECTORY", f"/var/lib/{state}")
        for path in (*self_signed.files(), default_state_file(11311)):
            assert path.is_relative_to(f"/var/lib/{state}")

    def test_unit_waits_longer_than_the_hub_takes_to_end(self) -> None:
        settings = dict(
            line.split("=", 1) for line in UNIT.read_text("utf-8").splitlines() if "=" in line
        )
        defaults = Settings()
        assert float(settings["TimeoutStopSec"]) > defaults.drain + defaults.close_timeout
        assert settings["Type"] == "notify" and float(settings["WatchdogSec"]) > 2


def mounts(service: Mapping[str, Any]) -> dict[str, str]:
    """Return what a service of Compose mounts, by the path in the container."""
    parts = [volume.split(":") for volume in service["volumes"]]
    return {part[1]: part[0] for part in parts}


class TestCompose:
    def test_hub_accepts_its_command(self) -> None:
        hub = COMPOSE["services"]["hub"]
        assert hub["command"][:3] == ["python", "-m", "fibws.hub"]
        flags = [SHELL_VARIABLE.sub(r"\1", flag) for flag in hub["command"][3:]]
        settings = environment_settings(flags)
        assert settings.host == "0.0.0.0"
        assert settings.allow_origin == ("https://localhost",)
        assert "proxy" in COMPOSE["services"]
        (network,) = COMPOSE["networks"]["default"]["ipam"]["config"]
        assert settings.trusted_proxy == (SHELL_VARIABLE.sub(r"\1", network["subnet"]),)
        grace = float(hub["stop_grace_period"].removesuffix("s"))
        assert grace > settings.drain + settings.close_timeout

    def test_tokens_are_made_where_they_are_read(self) -> None:
        services = COMPOSE["services"]
        made = mounts(services["token"])
        variables = services["token"]["environment"]
        hub = environment_settings(
            [SHELL_VARIABLE.sub(r"\1", flag) for flag in services["hub"]["command"][3:]]
        )
        assert hub.tokens is not None and str(hub.tokens) == variables["FIBWS_TOKENS"]
        folder = str(hub.tokens.parent)
        assert made[folder] == mounts(services["hub"])[folder]
        steps = (DEPLOY / "compose" / "compose.yaml").read_text("utf-8").partition("services:")[0]
        config = yaml.safe_load((DEPLOY / "compose" / "prometheus" / "prometheus.yml").read_text())
        (token,) = strings_in(config, "credentials_file")
        assert f"> {token}'" in steps
        folder = token.rpartition("/")[0]
        assert made[folder] == mounts(services["prometheus"])[folder]

    def test_folders_of_tokens_belong_to_the_user_of_the_image(self) -> None:
        """A new volume takes them from the image; nobody else on the machine may read it."""
        image = (ROOT / "Dockerfile").read_text("utf-8").replace("\\\n", "")
        options = "--directory --owner fibws --group fibws --mode 750"
        found = re.search(rf"install {options} ([^&\n]*)", image)
        assert found is not None
        services = COMPOSE["services"]
        assert set(found[1].split()) == {*mounts(services["token"]), *mounts(services["hub"])}
        (user,) = re.findall(r"^USER (\d+)$", image, re.M)
        assert f"--uid {user} fibws" in image
        assert COMPOSE["services"]["prometheus"]["group_add"] == [user]

    @needs("caddy")
    async def test_wrong_tokens_count_by_address_behind_the_proxy(
        self, tmp_path: Path, start: Start
    ) -> None:
        """The steps at the top of the file, with programs in place of containers."""
        token = await asyncio.to_thread(made_token, tmp_path)
        address = f"127.{os.getpid() >> 8 & 0xFF}.{os.getpid() & 0xFF}.1"
        flags = [
            re.sub(r"=(/etc/|/var/)", rf"={tmp_path}\1", flag)
            for flag in COMPOSE["services"]["hub"]["command"][3:]
            if not flag.startswith("--log-format")
        ]
        subnet, site = "${FIBWS_SUBNET:-172.30.90.0/24}", "${FIBWS_SITE:-localhost}"
        assert any(subnet in flag for flag in flags) and any(site in flag for flag in flags)
        values = {subnet: "127.0.0.1", site: SITE}
        flags = [SHELL_VARIABLE.sub(lambda found: values[found[0]], flag) for flag in flags]
        hub = await start("fibws.hub", *flags, "--port=0", "--host=127.0.0.1")
        found = re.search(r"127\.0\.0\.1:\d+", await hub.line())
        assert found is not None
        async with caddy(tmp_path, address, found[0]) as trusted:

            def client(at: str, token: str) -> connect:
                return connect(
                    f"wss://{SITE}/",
                    host=address,
                    local_addr=(at, 0),
                    ssl=trusted,
                    proxy=None,
                    origin=Origin(f"https://{SITE}"),
                    additional_headers={"Authorization": f"Bearer {token}"},
                )

            async def refused(at: str) -> int | None:
                with pytest.raises(ConnectionClosed) as closed:
                    async with client(at, "wrong") as stranger:
                        await stranger.recv()
                return closed.value.rcvd.code if closed.value.rcvd is not None else None

            while await refused("127.0.0.2") != LIMITED:
                pass
            assert await refused("127.0.0.3") == UNAUTHENTICATED
            async with client("127.0.0.3", token) as robot:
                await robot.send(json.dumps({"op": "subscribe", "topic": "/rosout"}))
                await (await robot.ping())

    @needs("caddy")
    @pytest.mark.parametrize("variables", [{}, {"FIBWS_SITE": "robot.example"}])
    def test_caddy_accepts_its_file(self, tmp_path: Path, variables: dict[str, str]) -> None:
        path = str(DEPLOY / "compose" / "caddy" / "Caddyfile")
        home = {"HOME": str(tmp_path), **variables}
        checked("caddy", "validate", "--config", path, "--adapter", "caddyfile", **home)
        adapted = json.loads(
            subprocess.run(
                ["caddy", "adapt", "--config", path, "--adapter", "caddyfile"],
                capture_output=True,
                check=True,
                env={"PATH": "/usr/bin:/usr/local/bin", **home},
            ).stdout
        )
        assert list(strings_in(adapted, "dial")) == ["hub:9090"]
        assert variables.get("FIBWS_SITE", "localhost") in json.dumps(adapted)


def made_token(root: Path) -> str:
    """Make the tokens as the first lines of the file say; return the robot's."""
    text = (DEPLOY / "compose" / "compose.yaml").read_text("utf-8").partition("x-service:")[0]
    steps = re.findall(r"^#   (docker compose run .*(?:\n#     .*)?)$", text, re.MULTILINE)
    lines = [step.replace("\n#", "\n") for step in steps if " revoke " not in step]
    assert len(lines) == 2
    programs = root / "programs"
    for folder in (programs, root / "etc/fibws/tokens", root / "etc/fibws/prometheus"):
        folder.mkdir(parents=True)
    (root / "var/lib/fibws").mkdir(parents=True)
    scripts = {
        "fibws": f'exec {sys.executable} -m fibws "$@"',
        "docker": 'shift 3; [ "$1" = token ] && exec fibws "$@"; shift 3; exec sh "$@"',
    }
    for name, script in scripts.items():
        (programs / name).write_text(f"#!/bin/sh\n{script}\n")
        (programs / name).chmod(0o755)
    printed = checked(
        *("bash", "-eu", "-c", "\n".join(lines).replace("/etc/fibws", f"{root}/etc/fibws")),
        PATH=f"{programs}:/usr/bin:/bin",
        FIBWS_TOKENS=f"{root}/etc/fibws/tokens/tokens.toml",
    )
    token, written = printed.split()[0], (root / "etc/fibws/prometheus/token").read_text()
    assert written.startswith("fibws_") and not written.startswith(token)
    return token


@asynccontextmanager
async def caddy(folder: Path, address: str, hub: str) -> AsyncIterator[ssl.SSLContext]:
    """Run Caddy with the file of Compose at an address; yield what trusts its certificate."""
    text = (DEPLOY / "compose" / "caddy" / "Caddyfile").read_text("utf-8")
    assert "hub:9090" in text
    options = f"admin off\nskip_install_trust\nauto_https disable_redirects\ndefault_bind {address}"
    config = folder / "Caddyfile"
    config.write_text(f"{{\n{options}\n}}\n{text.replace('hub:9090', hub)}")
    process = await asyncio.create_subprocess_exec(
        *("caddy", "run", "--config", str(config), "--adapter", "caddyfile"),
        env={
            "HOME": str(folder),
            "PATH": "/usr/bin:/usr/local/bin",
            "FIBWS_SITE": "localhost:9443",
        },
        stderr=asyncio.subprocess.PIPE,
    )
    root = folder / ".local/share/caddy/pki/authorities/local/root.crt"
    try:
        async with asyncio.timeout(PATIENCE):
            while True:
                try:
                    trusted = ssl.create_default_context(cafile=root)
                    _, writer = await asyncio.open_connection(
                        address, 9443, ssl=trusted, server_hostname="localhost"
                    )
                except OSError:
                    assert process.returncode is None and process.stderr is not None
                    await asyncio.sleep(0.01)
                else:
                    writer.close()
                    break
        yield trusted
    finally:
        if process.returncode is None:
            process.terminate()
        await process.communicate()


def prometheus_files(folder: Path, token: str = "one", **replaced: str) -> Path:
    """Copy the files of Prometheus with a token of its own; return the path of the first one."""
    credentials = folder / "prometheus.token"
    credentials.write_text(token)
    text = (DEPLOY / "compose" / "prometheus" / "prometheus.yml").read_text("utf-8")
    for old, new in {"/etc/fibws/prometheus/token": str(credentials), **replaced}.items():
        assert old in text
        text = text.replace(old, new)
    path = folder / "prometheus.yml"
    path.write_text(text)
    shutil.copy(ALERTS, folder)
    return path


def samples(metric: str, **labels: str) -> str:
    pairs = {"job": "fibws", "instance": "hub:9090", **labels}
    values = ",".join(f'{name}="{value}"' for name, value in pairs.items())
    return f"{metric}{{{values}}}"


def lag(seconds: str) -> str:
    return samples("fibws_loop_lag_seconds_bucket", le=seconds)


HEALTHY = {
    samples("up"): "1x80",
    samples("process_start_time_seconds"): "1769850000x80",
    samples("process_open_fds"): "60x80",
    samples("process_max_fds"): "10256x80",
    samples("fibws_clients"): "40x80",
    samples("fibws_clients_limit"): "10000x80",
    samples("fibws_send_queue_bytes"): "4096x80",
    samples("fibws_send_queue_bytes_limit"): "536870912x80",
    samples("fibws_dropped_messages_total"): "0+1x80",
    samples("fibws_refusals_total", reason="authentication"): "0x20 3x60",
    samples("fibws_refusals_total", reason="limit"): "0x80",
    samples("fibws_service_failures_total", service="/dock", code="timeout"): "0x30 1x50",
    samples("fibws_links_down"): "0x10 1x4 0x80",
    samples("fibws_certificate_expiry_timestamp_seconds"): "864000x80",
    samples("fibws_recording_dropped_messages_total"): "0x80",
    samples("fibws_recording_failed"): "0x10 1x2 0x80",
    samples("fibws_parameters_unsaved"): "0x10 1x2 0x80",
    lag("0.005"): "0+74x80",
    lag("0.5"): "0+75x80",
    lag("+Inf"): "0+75x80",
}
"""What Prometheus sees of a hub that is well, every 15 s for 20 minutes: an error now and then."""
INCIDENTS = {
    "HubDown": {samples("up"): "1x70 0x10"},
    "HubRestarted": {samples("process_start_time_seconds"): "1769850000x40 1769850600x40"},
    # A blocking callback: one of ten timers is late.
    "HubLate": {lag("0.005"): "0+67x80", lag("0.25"): "0+67x80"},
    "MessagesDropped": {samples("fibws_dropped_messages_total"): "0+300x80"},
    "QueuesFull": {samples("fibws_send_queue_bytes"): "4096x60 500000000x20"},
    "ManyClients": {samples("fibws_clients"): "9000x80"},
    "ManyOpenFiles": {samples("process_open_fds"): "900x80", samples("process_max_fds"): "1024x80"},
    # One address that tries ten tokens a second: all but one of them are refused for the limit.
    "WrongTokens": {
        samples("fibws_refusals_total", reason="authentication"): "0x20 20+15x60",
        samples("fibws_refusals_total", reason="limit"): "0x20 0+135x60",
    },
    "ServiceFailing": {
        samples("fibws_service_failures_total", service="/dock", code="timeout"): "0+6x80"
    },
    "LinkDown": {samples("fibws_links_down"): "0x60 1x20"},
    "ParametersUnsaved": {samples("fibws_parameters_unsaved"): "0x60 1x20"},
    "CertificateEnds": {samples("fibws_certificate_expiry_timestamp_seconds"): "259200x80"},
    "RecordingFailed": {samples("fibws_recording_failed"): "0x60 1x20"},
    "RecordingDrops": {samples("fibws_recording_dropped_messages_total"): "0x70 40x10"},
}
"""What is different in the incident of each alert."""


class TestPrometheus:
    @needs("promtool")
    def test_it_accepts_its_configuration_and_the_alerts(self, tmp_path: Path) -> None:
        output = checked("promtool", "check", "config", str(prometheus_files(tmp_path)))
        assert "rules found" in output

    @needs("promtool")
    @pytest.mark.parametrize("alert", [None, *INCIDENTS], ids=str)
    def test_alert_fires_in_its_incident_alone(self, tmp_path: Path, alert: str | None) -> None:
        series = HEALTHY if alert is None else HEALTHY | INCIDENTS[alert]
        firing = [] if alert is None else [{"labels": f'{{alertname="{alert}"}}', "value": 1}]
        test = {
            "interval": "15s",
            "input_series": [{"series": name, "values": values} for name, values in series.items()],
            "promql_expr_test": [
                {
                    "expr": 'count by (alertname) (ALERTS{alertstate="firing"})',
                    "eval_time": "20m",
                    "exp_samples": firing,
                }
            ],
        }
        path = tmp_path / "incident.yml"
        document = {"rule_files": [str(ALERTS)], "evaluation_interval": "15s", "tests": [test]}
        path.write_text(yaml.safe_dump(document))
        assert "SUCCESS" in checked("promtool", "test", "rules", str(path))

    def test_each_alert_has_an_incident(self) -> None:
        alerts = list(strings_in(yaml.safe_load(ALERTS.read_text("utf-8")), "alert"))
        assert sorted(alerts) == sorted(INCIDENTS)

    async def test_alerts_name_metrics_of_the_hub(
        self, start_hub: StartHub, authority: Authority, tmp_path: Path
    ) -> None:
        # Some metrics are there only with a recorder, or with another hub, which need not answer.
        certificate, key = authority.issue()
        hub = await start_hub(
            cert=certificate,
            key=key,
            record=tmp_path,
            join=("ws://127.0.0.1:1",),
            params=tmp_path / "params.yaml",
            keep_params=True,
        )
        known = {sample for family in families(hub) for sample in family}
        for expression in strings_in(yaml.safe_load(ALERTS.read_text("utf-8")), "expr"):
            for name in re.findall(r"\b(?:fibws|process)_\w+", expression):
                assert name in known, expression

    @needs("prometheus")
    async def test_it_scrapes_a_hub_with_tokens(self, start_hub: StartHub, tmp_path: Path) -> None:
        tokens = tmp_path / "tokens.toml"
        tokens.write_text(f'[tokens.prometheus]\nsha256 = "{digest_of("one")}"\nadmin = true\n')
        hub = await start_hub(tokens=tokens)
        config = prometheus_files(tmp_path, **{"hub:9090": f"127.0.0.1:{hub.port}", "15s": "200ms"})
        async with prometheus(config, tmp_path / "data") as address:
            found = await queried(address, "fibws_topics")
            assert found["metric"]["job"] == "fibws"
            assert float(found["value"][1]) == len(hub.graph.topics)
            assert float((await queried(address, 'up{job="fibws"}'))["value"][1]) == 1
            await queried(address, "fibws_loop_lag_seconds_bucket")
        assert hub.audit.refusals["authentication"] == 0


def families(hub: HubServer) -> list[list[str]]:
    """Return the names of all samples of a hub, also of those that have no values yet."""
    response = hub._requests.respond(Request("/metrics", Headers()), "127.0.0.1")
    assert response is not None
    return [
        [family.name, f"{family.name}_total", *(sample.name for sample in family.samples)]
        for family in text_string_to_metric_families(bytes(response.body).decode())
    ]


@asynccontextmanager
async def prometheus(config: Path, data: Path) -> Any:
    """Run Prometheus; yield its address."""
    process = await asyncio.create_subprocess_exec(
        "prometheus",
        f"--config.file={config}",
        f"--storage.tsdb.path={data}",
        "--web.listen-address=127.0.0.1:0",
        stderr=asyncio.subprocess.PIPE,
    )
    assert process.stderr is not None
    try:
        async with asyncio.timeout(PATIENCE):
            async for line in process.stderr:
                if b"Listening on" in line:
                    break
            found = re.search(rb"127\.0\.0\.1:\d+", line)
        assert found is not None, line
        reading = asyncio.create_task(process.stderr.read())  # Or its log would fill the pipe.
        yield found[0].decode()
    finally:
        process.terminate()
        await process.wait()
    await reading


async def queried(address: str, query: str) -> dict[str, Any]:
    """Return the first result of a query once there is one."""
    url = f"http://{address}/api/v1/query?query={quote(query)}"

    def ask() -> list[dict[str, Any]]:
        try:
            with urllib.request.urlopen(url) as response:
                found: list[dict[str, Any]] = json.load(response)["data"]["result"]
                return found
        except urllib.error.HTTPError:  # It is not ready yet.
            return []

    async with asyncio.timeout(PATIENCE):
        while not (results := await asyncio.to_thread(ask)):  # noqa: ASYNC110 - it has no event.
            await asyncio.sleep(0.05)
    return results[0]


class TestKubernetes:
    """The structure; `kubernetes-validate` knows all of it, but takes 100 MB."""

    @property
    def pod(self) -> dict[str, Any]:
        spec: dict[str, Any] = KUBERNETES["Deployment"]["spec"]["template"]["spec"]
        return spec

    @property
    def container(self) -> dict[str, Any]:
        (container,) = self.pod["containers"]
        return dict(container)

    def settings(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Settings:
        """Return the settings of the hub in the pod."""
        command = self.container["command"]
        assert command[:4] == ["python", "-m", "fibws.hub", "--config"]
        config = tmp_path / "hub.toml"
        config.write_text(KUBERNETES["ConfigMap"]["data"]["hub.toml"])
        monkeypatch.setenv("FIBWS_CONFIG", str(config))
        return environment_settings(command[5:])

    def test_settings_are_valid_and_leave_time_to_drain(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        settings = self.settings(tmp_path, monkeypatch)
        assert settings.host == "0.0.0.0"
        assert "Ingress" in KUBERNETES and settings.trusted_proxy
        grace = self.pod["terminationGracePeriodSeconds"]
        assert grace > settings.drain + settings.close_timeout

    def test_files_are_mounted_where_the_settings_expect_them(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        volumes = {volume["name"]: volume for volume in self.pod["volumes"]}
        mounted = {mount["name"]: mount["mountPath"] for mount in self.container["volumeMounts"]}
        assert volumes.keys() == mounted.keys()
        assert volumes["config"]["configMap"]["name"] == KUBERNETES["ConfigMap"]["metadata"]["name"]
        assert f"{mounted['config']}/hub.toml" == self.container["command"][4]
        tokens = self.settings(tmp_path, monkeypatch).tokens
        assert tokens is not None and str(tokens.parent) == mounted["tokens"]
        steps = (DEPLOY / "kubernetes" / "fibws.yaml").read_text("utf-8")
        name = volumes["tokens"]["secret"]["secretName"]
        assert f"kubectl create secret generic {name} --from-file={tokens.name}" in steps

    def test_service_finds_the_pod_and_the_ingress_the_service(self) -> None:
        labels = KUBERNETES["Deployment"]["spec"]["template"]["metadata"]["labels"]
        service = KUBERNETES["Service"]
        assert service["spec"]["selector"] == labels
        assert KUBERNETES["Deployment"]["spec"]["selector"]["matchLabels"] == labels
        (port,) = service["spec"]["ports"]
        (container_port,) = self.container["ports"]
        assert port["targetPort"] == container_port["name"]
        assert container_port["containerPort"] == Settings().port
        (rule,) = KUBERNETES["Ingress"]["spec"]["rules"]
        (path,) = rule["http"]["paths"]
        backend = path["backend"]["service"]
        assert backend["name"] == service["metadata"]["name"]
        assert backend["port"]["name"] == port["name"]

    async def test_hub_answers_the_probes(self, hub: HubServer) -> None:
        for name in ("startupProbe", "livenessProbe", "readinessProbe"):
            probe = self.container[name]["httpGet"]
            assert probe["port"] == self.container["ports"][0]["name"]
            request = Request(probe["path"], Headers({"Host": "10.0.0.3:9090"}))
            response = hub._requests.respond(request, "10.0.0.1")
            assert response is not None and response.status_code == 200
