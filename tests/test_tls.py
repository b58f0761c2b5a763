"""TLS of nodes and tools: their certificates, and what errors say."""

from __future__ import annotations

import asyncio
import os
import shutil
import ssl
import sys
from collections.abc import Awaitable, Callable
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path

import pytest
from certificates import Authority, add_password
from certificates import authority as authority
from click.testing import CliRunner
from client.servers import redirecting_server
from conftest import StartHub
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from hub_reload import reloaded
from node.conftest import Lines

import fibws
from fibws import HubUnreachable, tls
from fibws.access.rights import Rights
from fibws.access.token_file import TokenFile
from fibws.cli.commands import command
from fibws.client.hub_client import HubClient
from fibws.hub.server import HubServer
from fibws.msg.std_msgs import String

VARIABLES = (tls.CA, tls.CLIENT_CERT, tls.CLIENT_KEY, "SSL_CERT_FILE")


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
async def hub(start_hub: StartHub, authority: Authority) -> HubServer:
    """A hub with TLS, which lets everybody in."""
    certificate, key = authority.issue()
    return await start_hub(cert=certificate, key=key)


@pytest.fixture
async def closed_hub(start_hub: StartHub, authority: Authority) -> HubServer:
    """A hub with TLS, which lets in clients with certificates of its authority."""
    certificate, key = authority.issue()
    return await start_hub(cert=certificate, key=key, client_ca=authority.file)


def names(hub: HubServer) -> set[str | None]:
    """Return the common names of the certificates of all clients."""
    return {each.certificate and each.certificate.name for each in hub._connections}


async def tool(url: str, hub: HubServer | None = None) -> set[str | None]:
    """Connect as a tool; return the names in the clients' certificates meanwhile."""

    def run() -> set[str | None]:
        with HubClient("test", url) as client:
            client.call("/rosapi/get_time")
            return names(hub) if hub is not None else set()

    return await asyncio.to_thread(run)


async def node(url: str, hub: HubServer | None = None) -> set[str | None]:
    """Connect as a node; return the names in the clients' certificates meanwhile."""
    async with fibws.Node("test", hub=url) as node:
        await node.graph.nodes()
        return names(hub) if hub is not None else set()


EITHER = pytest.mark.parametrize("program", [tool, node])
Program = Callable[..., Awaitable[set[str | None]]]


async def why(program: Program, url: str) -> str:
    """Return why a program does not reach a hub."""
    with pytest.raises(HubUnreachable) as caught:
        await program(url)
    return str(caught.value)


@EITHER
@pytest.mark.parametrize("variable", [tls.CA, "SSL_CERT_FILE"])
async def test_variable_names_trusted_certificates(
    program: Program,
    variable: str,
    hub: HubServer,
    authority: Authority,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv(variable, str(authority.file))
    await program(hub.url)


async def test_node_takes_its_certificates_as_arguments(
    closed_hub: HubServer, authority: Authority
) -> None:
    cert, key = authority.issue(common_name="arm", file="arm")
    async with fibws.Node(
        "test", hub=closed_hub.url, ca=authority.file, client_cert=cert, client_key=key
    ):
        assert names(closed_hub) == {"arm"}
        assert {each.principal and each.principal.name for each in closed_hub._connections} == {
            "arm"
        }


async def test_options_of_a_command_name_its_certificates(
    closed_hub: HubServer, authority: Authority
) -> None:
    cert, key = authority.issue(common_name="arm", file="arm")
    both = authority.file.with_name("both.pem")
    both.write_bytes(cert.read_bytes() + key.read_bytes())
    files = ("--ca", str(authority.file), "--client-cert", str(both))
    run = partial(CliRunner().invoke, command)
    result = await asyncio.to_thread(run, ["node", "list", "--hub", closed_hub.url, *files])
    assert result.exit_code == 0, result.output
    assert "/rosapi" in result.output
    assert not tls.TlsFiles.choose().ca
    result = await asyncio.to_thread(run, ["node", "list", "--hub", closed_hub.url])
    assert result.exit_code == 1
    assert tls.CA in result.output


@EITHER
async def test_client_certificate_is_presented(
    program: Program, closed_hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    cert, key = authority.issue(common_name="arm", file="arm")
    monkeypatch.setenv(tls.CA, str(authority.file))
    monkeypatch.setenv(tls.CLIENT_CERT, str(cert))
    monkeypatch.setenv(tls.CLIENT_KEY, str(key))
    assert await program(closed_hub.url, closed_hub) == {"arm"}


@EITHER
async def test_unknown_issuer_is_explained(program: Program, hub: HubServer) -> None:
    text = await why(program, hub.url)
    assert tls.CA in text
    assert "--ca" in text


@EITHER
async def test_other_name_is_explained(
    program: Program, hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(tls.CA, str(authority.file))
    url = hub.url
    authority.issue("robot.example")
    await reloaded(hub)
    assert "name that is in it" in await why(program, url)


@EITHER
async def test_expired_certificate_is_explained(
    program: Program, hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(tls.CA, str(authority.file))
    authority.issue(expires=datetime.now(UTC) - timedelta(days=1))
    await reloaded(hub)
    text = await why(program, hub.url)
    assert "expired" in text and "renew" in text


async def test_hub_without_tls_is_explained(start_hub: StartHub) -> None:
    hub = await start_hub()
    url = hub.url.replace("ws:", "wss:")
    assert "use ws://" in await why(tool, url)
    node = fibws.Node("test", hub=url)
    lines = Lines(node.log)
    waiting = asyncio.create_task(node.__aenter__())
    assert "use ws://" in await lines.next()
    waiting.cancel()


async def test_redirect_to_a_hub_with_tls_is_followed(
    hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(tls.CA, str(authority.file))
    with redirecting_server(hub.url.replace("wss:", "https:")) as url:
        assert await node(url, hub) == {None}


@EITHER
async def test_hub_with_tls_is_explained(program: Program, hub: HubServer) -> None:
    assert "wss://" in await why(program, hub.url.replace("wss:", "ws:"))


@EITHER
@pytest.mark.parametrize(
    ("fault", "reason"),
    [("issuer", "issuer is unknown"), ("expired", "has expired"), ("usage", "key usage")],
)
async def test_refused_client_certificate_is_explained(
    program: Program,
    fault: str,
    reason: str,
    closed_hub: HubServer,
    authority: Authority,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    use_client_certificate(monkeypatch, authority, *refused_certificate(authority, fault, tmp_path))
    text = await why(program, closed_hub.url)
    assert tls.CLIENT_CERT in text and reason in text


def refused_certificate(authority: Authority, fault: str, folder: Path) -> tuple[Path, Path]:
    """Return the files of a client's certificate that the authority's hub must refuse."""
    match fault:
        case "issuer":
            (folder / "other").mkdir()
            return Authority(folder / "other").issue(common_name="arm")
        case "expired":
            yesterday = datetime.now(UTC) - timedelta(days=1)
            return authority.issue(common_name="arm", file="arm", expires=yesterday)
        case _:
            return authority.issue_for_servers("arm")


def use_client_certificate(
    monkeypatch: pytest.MonkeyPatch, authority: Authority, certificate: Path, key: Path | None
) -> None:
    monkeypatch.setenv(tls.CA, str(authority.file))
    monkeypatch.setenv(tls.CLIENT_CERT, str(certificate))
    if key is not None:
        monkeypatch.setenv(tls.CLIENT_KEY, str(key))


@EITHER
async def test_client_certificate_without_its_key_is_explained(
    program: Program, closed_hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, _ = authority.issue(common_name="arm", file="arm")
    use_client_certificate(monkeypatch, authority, certificate, None)
    text = await why(program, closed_hub.url)
    assert f"{certificate} holds no private key" in text and tls.CLIENT_KEY in text


@EITHER
async def test_key_of_another_certificate_is_explained(
    program: Program, closed_hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, _ = authority.issue(common_name="arm", file="arm")
    _, other = authority.issue(common_name="arm", file="other")
    for key in (other, rsa_key(other.with_name("rsa.key"))):
        use_client_certificate(monkeypatch, authority, certificate, key)
        assert f"{key} is not the key of the first certificate" in await why(
            program, closed_hub.url
        )


def rsa_key(file: Path) -> Path:
    """Write a key of another kind than the authority's."""
    made = rsa.generate_private_key(65537, 2048)
    file.write_bytes(
        made.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.NoEncryption(),
        )
    )
    return file


@EITHER
async def test_key_with_a_password_is_refused_without_a_question(
    program: Program, closed_hub: HubServer, authority: Authority, monkeypatch: pytest.MonkeyPatch
) -> None:
    certificate, key = authority.issue(common_name="arm", file="arm")
    add_password(key)
    use_client_certificate(monkeypatch, authority, certificate, key)
    text = await why(program, closed_hub.url)
    assert tls.CLIENT_KEY in text and "has a password" in text


@EITHER
@pytest.mark.parametrize("variable", [tls.CA, tls.CLIENT_CERT])
@pytest.mark.parametrize("content", [None, "nonsense"])
async def test_file_that_cannot_be_used_is_named(
    program: Program,
    variable: str,
    content: str | None,
    hub: HubServer,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = tmp_path / "my.pem"
    if content is not None:
        file.write_text(content)
    monkeypatch.setenv(variable, str(file))
    text = await why(program, hub.url)
    assert variable in text and str(file) in text


def test_other_errors_are_not_those_of_tls() -> None:
    assert tls.fault(ConnectionRefusedError(111, "refused")) is None
    assert tls.fault(None) is None
    wrapped = ConnectionError("lost")
    wrapped.__cause__ = ssl.SSLError(1, "[SSL: WRONG_VERSION_NUMBER] wrong version number")
    assert tls.fault(wrapped) is not None


# Programs, which have variables or options.

ROSPY = """\
import rospy
from std_msgs.msg import String

rospy.init_node("talker")
publisher = rospy.Publisher("chatter", String, queue_size=1, latch=True)
publisher.publish("hello")
rospy.spin()
"""
ROSLIBPY = """\
import sys
import roslibpy

ros = roslibpy.Ros(sys.argv[1])
ros.run()
print(ros.get_topics())
ros.terminate()
"""
ROSLIB = """\
import * as ROSLIB from "roslib2";

const ros = new ROSLIB.Ros({ url: process.argv[1] });
ros.on("connection", () => ros.getTopics((found) => {
  console.log(JSON.stringify(found));
  process.exit(0);
}));
"""


async def hears_the_talker(
    hub: HubServer, authority: Authority, *command: str, **variables: str
) -> None:
    """Run a program whose node says hello on /chatter."""
    process = await asyncio.create_subprocess_exec(*command, env={**os.environ, **variables})
    try:
        async with asyncio.timeout(60), fibws.Node("ear", hub=hub.url, ca=authority.file) as ear:
            message = await anext(ear.subscribe("chatter", String))
            assert message.data == "hello"
    finally:
        process.terminate()
        await process.wait()


async def test_rospy_script_connects_with_tls(
    hub: HubServer, authority: Authority, tmp_path: Path
) -> None:
    script = tmp_path / "talker.py"
    script.write_text(ROSPY)
    variables = {"FIBWS_HUB": hub.url, tls.CA: str(authority.file)}
    command = (sys.executable, "-m", "fibws.rospy", str(script))
    await hears_the_talker(hub, authority, *command, **variables)


@pytest.mark.long
async def test_launched_nodes_have_the_certificates_of_an_option(
    hub: HubServer, authority: Authority, tmp_path: Path
) -> None:
    package = tmp_path / "src" / "robot"
    (package / "scripts").mkdir(parents=True)
    (package / "package.xml").write_text(
        '<package format="2"><name>robot</name><version>0.0.0</version><description>x</description>'
        '<maintainer email="a@example.com">a</maintainer><license>BSD</license></package>'
    )
    script = package / "scripts" / "talker.py"
    script.write_text(f"#!{sys.executable}\n{ROSPY}")
    script.chmod(0o755)
    file = tmp_path / "robot.launch"
    file.write_text('<launch><node pkg="robot" type="talker.py" name="talker"/></launch>')
    variables = {"ROS_PACKAGE_PATH": str(tmp_path / "src"), "ROS_HOME": str(tmp_path / "home")}
    options = ("--hub", hub.url, "--ca", str(authority.file))
    command = (sys.executable, "-m", "fibws", "launch", str(file), *options)
    await hears_the_talker(hub, authority, *command, **variables)


async def topics_of(*command: str, folder: Path | None = None, **variables: str) -> str:
    """Return what a program prints."""
    process = await asyncio.create_subprocess_exec(
        *command, cwd=folder, env={**os.environ, **variables}, stdout=asyncio.subprocess.PIPE
    )
    async with asyncio.timeout(60):
        output, _ = await process.communicate()
    return output.decode()


async def test_roslibpy_connects_with_tls(hub: HubServer, authority: Authority) -> None:
    command = (sys.executable, "-W", "ignore", "-c", ROSLIBPY, hub.url)
    assert "/rosout" in await topics_of(*command, SSL_CERT_FILE=str(authority.file))


@pytest.mark.npm
async def test_roslib_connects_with_tls(hub: HubServer, authority: Authority) -> None:
    folder = Path(__file__).parent / "clients"
    if shutil.which("node") is None or not (folder / "node_modules").exists():
        pytest.skip("needs Node.js and `npm ci` in tests/clients")
    command = ("node", "--input-type=module", "-e", ROSLIB, hub.url)
    found = await topics_of(*command, folder=folder, NODE_EXTRA_CA_CERTS=str(authority.file))
    assert "/rosout" in found


@EITHER
async def test_token_is_sent_with_tls_but_not_after_a_redirect_to_it(
    program: Program,
    start_hub: StartHub,
    authority: Authority,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = TokenFile(tmp_path / "tokens.toml")
    monkeypatch.setenv("FIBWS_TOKEN", file.add("arm", Rights({"subscribe": ("/**",)})))
    monkeypatch.setenv(tls.CA, str(authority.file))
    certificate, key = authority.issue()
    hub = await start_hub(cert=certificate, key=key, tokens=tmp_path / "tokens.toml")
    await program(hub.url)
    with redirecting_server(hub.url.replace("wss:", "https:")) as url:
        with pytest.raises(fibws.NotAuthorized, match="redirects"):
            await program(url)
