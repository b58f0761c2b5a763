"""The hub's settings: their defaults, units and purposes."""

from __future__ import annotations

import ipaddress
import math
import re
from dataclasses import Field, dataclass, field, fields
from functools import cache
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from fibws.access.rights import check_glob
from fibws.credentials import Credentials
from fibws.errors import AccessError, FibwsError, SettingError
from fibws.hub.http.proxies import Network, parse_network
from fibws.hub_address import hub_url
from fibws.origins import is_allowable
from fibws.suggestions import suggestion

KIB = 1024
MIB = 1024 * KIB
URL_PATH = r"(/[A-Za-z0-9._~!$&'()*+,;=:@%-]+)*/?"
"""The segments of a URL's path (RFC 3986, section 3.3)."""

GLOBAL_NAME = r"(/[A-Za-z]\w*)+"

ENDPOINT = r"(?:tcp|udp|tls|quic|ws)/(?:\[[0-9A-Fa-f:.%]+\]|[^\s:/\[\]]+):(\d{1,5})([?#]\S*)?"
"""An endpoint of zenoh that has a host and a port."""
OTHER_ENDPOINT = r"(?:serial|unixsock-stream|unixpipe|vsock)/\S+"

_NEEDED = {
    "auth_timeout": ("tokens", "jwt_key", "client_ca"),
    "ros1_allow": ("ros1",),
    "ros1_state": ("ros1",),
    "join_prefix": ("join", "zenoh", "zenoh_listen"),
    "join_export": ("join", "zenoh", "zenoh_listen"),
    "join_import": ("join", "zenoh", "zenoh_listen"),
    "zenoh_config": ("zenoh", "zenoh_listen"),
    "domain": ("zenoh", "zenoh_listen"),
    "ros2_domain": ("ros2", "ros2_connect"),
    **dict.fromkeys(
        (
            *("record_at_start", "record_mcap", "record_compression", "record_size"),
            *("record_duration", "record_files", "record_min_space", "record_buffer"),
        ),
        ("record",),
    ),
}
"""Settings that have no effect unless one of others is there."""

_SURROGATE = re.compile("[\ud800-\udfff]")
LOG_FORMATS = ("text", "json")
COMPRESSIONS = ("none", "bz2", "lz4", "zstd")
DEFLATE = ("auto", "always", "never")


def _setting(default: Any, help_: str, flag: str = "") -> Any:
    """Return a setting; its flag is its name, unless another one is given."""
    return field(default=default, metadata={"help": help_, "flag": flag})


def flag_of(setting: Field[Any]) -> str:
    """Return the flag of a setting, without the dashes before it."""
    return setting.metadata["flag"] or setting.name.replace("_", "-")


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """The hub's settings; each is a flag of ``python -m fibws.hub`` as well.

    Raises:
        SettingError: a value has another type, a number is negative, a port is too large, or an
            origin is not one.
    """

    host: str = _setting(
        "127.0.0.1",
        "Address to listen on; 0.0.0.0 accepts connections from other machines, :: also by IPv6.",
    )
    port: int = _setting(9090, "Port to listen on; 0 chooses a free one.")
    cert: Path | None = _setting(
        None, "Certificate for TLS, in PEM format; the hub is then at wss:// and https://."
    )
    key: Path | None = _setting(None, "Private key of the certificate, without a password.")
    self_signed: bool = _setting(
        False, "Use a certificate made by this machine, for development and for phones."
    )
    url_path: str = _setting(
        "", "Path of the page and of all else, such as /robot, behind a proxy that keeps it."
    )
    trusted_proxy: tuple[str, ...] = _setting(
        (),
        "Address or network (CIDR) of a proxy whose headers X-Forwarded-For, -Proto and -Host "
        "count; may be repeated.",
    )
    allow_origin: tuple[str, ...] = _setting(
        (),
        "Web page origin that may connect besides this machine's own, such as "
        "https://lab.example, null (pages opened as files) or * (any); may be repeated.",
    )
    tokens: Path | None = _setting(
        None, "File of the tokens that clients need, from `fibws token add`; without, none do."
    )
    jwt_key: Path | None = _setting(
        None,
        "Key that signs JSON web tokens: a secret for HS256, else a public key in PEM or JWKS.",
    )
    jwt_algorithm: str = _setting(
        "HS256", "Algorithm of JSON web tokens: HS256, EdDSA, ES256 or RS256."
    )
    jwt_audience: str = _setting("", "Audience (aud) that JSON web tokens must be for.")
    jwt_leeway: float = _setting(10.0, "Seconds by which the clock of their issuer may differ.")
    client_ca: Path | None = _setting(
        None, "Certificate authority (PEM) whose client certificates stand for tokens."
    )
    auth_timeout: float = _setting(
        5.0, "Seconds in which a client must send its token if it has none in its handshake."
    )
    ros1: int | None = _setting(
        None,
        "Port of a ROS 1 master for nodes of a real ROS, usually 11311; 0 chooses a free one. "
        "Default: no master.",
    )
    ros1_host: str = _setting(
        "",
        "Name or address of this machine for ROS 1 nodes; by default $ROS_HOSTNAME, $ROS_IP, or "
        "the address by which each node has reached the hub.",
    )
    ros1_allow: tuple[str, ...] = _setting(
        (),
        "Address or network (CIDR) whose ROS 1 nodes may join besides this machine's; may be "
        "repeated. ROS 1 has no passwords.",
    )
    ros1_state: Path | None = _setting(
        None,
        "File that remembers the ROS 1 nodes for when the hub is restarted; by default in "
        "~/.local/state/fibws.",
    )
    hub_name: str = _setting(
        "", "Name of this hub for people and other hubs; by default the name of the machine."
    )
    join: tuple[str, ...] = _setting(
        (),
        "URL of another hub to join, such as wss://cloud.example/?token=...; its nodes and this "
        "hub's share one graph. May be repeated.",
    )
    join_prefix: str = _setting(
        "",
        "Name, such as /robot7, below which the nodes and topics of this hub appear at the hubs "
        "that it joins, and outside of which it sees nothing of them.",
        flag="as",
    )
    join_export: tuple[str, ...] = _setting(
        (),
        "Glob of topics, services, actions and parameters that the joined hubs get, such as "
        "/scan or /camera/**; may be repeated. Default: all.",
        flag="export",
    )
    join_import: tuple[str, ...] = _setting(
        (),
        "Glob of topics, services, actions and parameters to take from the joined hubs; may be "
        "repeated. Default: all.",
        flag="import",
    )
    share_params: tuple[str, ...] = _setting(
        (),
        "Namespace of parameters, such as /fleet, that this hub shares with the others; may be "
        "repeated. The last change wins.",
    )
    zenoh_listen: tuple[str, ...] = _setting(
        (),
        "Endpoint, such as tcp/0.0.0.0:7447, to let other hubs join over zenoh; may be repeated.",
    )
    zenoh: tuple[str, ...] = _setting(
        (),
        "Endpoint of another hub, or of a zenohd, to join over zenoh, such as tcp/lab:7447; or "
        "auto, to find hubs on the local network. May be repeated.",
    )
    zenoh_config: Path | None = _setting(
        None, "zenoh's own configuration file (JSON5), for TLS and access control."
    )
    domain: str = _setting("default", "Name of the group of hubs on the zenoh network to join.")
    ros2: tuple[str, ...] = _setting(
        (),
        "Endpoint, such as tcp/0.0.0.0:7447, to let ROS 2 nodes with rmw_zenoh join; may be "
        "repeated.",
    )
    ros2_connect: tuple[str, ...] = _setting(
        (),
        "Endpoint of a zenoh router of ROS 2 nodes to connect to, such as tcp/robot:7447; may be "
        "repeated.",
    )
    ros2_domain: int = _setting(0, "ROS_DOMAIN_ID of the ROS 2 nodes.")
    record: Path | None = _setting(
        None, "Folder to record all topics in, as bags; the page and services start and stop it."
    )
    record_at_start: bool = _setting(True, "Begin to record when the hub starts.")
    record_mcap: bool = _setting(False, "Record MCAP files (.mcap) rather than ROS 1 bags (.bag).")
    record_compression: Literal["none", "bz2", "lz4", "zstd"] = _setting(
        "none", "Compression of recorded bags: none; bz2 or lz4 for .bag; lz4 or zstd for .mcap."
    )
    record_size: int = _setting(
        1024, "Megabytes (MiB) after which the recording continues in another file; 0 for no limit."
    )
    record_duration: float = _setting(
        0.0, "Seconds after which the recording continues in another file; 0 for no limit."
    )
    record_files: int = _setting(
        0, "Files of one recording that are kept, the newest ones; 0 keeps all."
    )
    record_min_space: int = _setting(
        1024, "Megabytes (MiB) of free disk space below which nothing is recorded."
    )
    record_buffer: int = _setting(
        256, "Megabytes (MiB) of messages that may wait for the disk; then the oldest are dropped."
    )
    params: Path | None = _setting(
        None, "YAML file of parameters to set at the start, as from `fibws param dump`."
    )
    keep_params: bool = _setting(
        False, "Write the parameters to the file of --params after changes, and at the end."
    )
    interfaces: tuple[Path, ...] = _setting(
        (), "Folder of message definitions (PACKAGE/msg/*.msg); may be repeated."
    )
    strict_types: bool = _setting(
        False, "Refuse topics whose type's package is unknown, rather than relay them unchecked."
    )
    queue_length: int = _setting(
        1000, "Messages kept for a slow subscription that names no queue_length."
    )
    service_timeout: float = _setting(
        60.0, "Seconds in which a service must answer if the call names no timeout; 0 for no limit."
    )
    strict_responses: bool = _setting(
        False,
        "Treat a service_response whose result is false as a failure even if it has values.",
    )
    max_connections: int = _setting(
        10_000, "Clients that may be connected at once; fewer if the limit of open files is lower."
    )
    max_advertisements: int = _setting(
        5000, "Topics that one client may advertise; as many services and actions, too."
    )
    max_subscriptions: int = _setting(5000, "Topics that one client may subscribe to.")
    max_messages_per_second: float = _setting(
        0.0, "Messages per second that one client may send, pings included; 0 for no limit."
    )
    max_bytes_per_second: float = _setting(
        0.0, "Bytes per second that one client may send; 0 for no limit."
    )
    max_address_connections: int = _setting(
        0, "Clients of one IP address (IPv6: /64 network) that may be connected; 0 for no limit."
    )
    max_address_subscriptions: int = _setting(
        0, "Topics that the clients of one address may subscribe to; 0 for no limit."
    )
    max_address_advertisements: int = _setting(
        0,
        "Topics, services and actions that the clients of one address may advertise; "
        "0 for no limit.",
    )
    max_address_messages_per_second: float = _setting(
        0.0, "Messages per second that the clients of one address may send; 0 for no limit."
    )
    max_address_bytes_per_second: float = _setting(
        0.0, "Bytes per second that the clients of one address may send; 0 for no limit."
    )
    max_address_handshakes_per_second: float = _setting(
        1000.0,
        "WebSocket handshakes, and HTTP requests with a token, per second of one address; "
        "0 for no limit.",
    )
    max_principal_connections: int = _setting(
        0, "Clients of one principal (token) that may be connected; 0 for no limit."
    )
    max_principal_subscriptions: int = _setting(
        0, "Topics that the clients of one principal may subscribe to; 0 for no limit."
    )
    max_principal_advertisements: int = _setting(
        0,
        "Topics, services and actions that the clients of one principal may advertise; "
        "0 for no limit.",
    )
    max_principal_messages_per_second: float = _setting(
        0.0, "Messages per second that the clients of one principal may send; 0 for no limit."
    )
    max_principal_bytes_per_second: float = _setting(
        0.0, "Bytes per second that the clients of one principal may send; 0 for no limit."
    )
    max_calls: int = _setting(
        1000, "Service calls of one client that may wait for a response at once."
    )
    max_goals: int = _setting(1000, "Goals of one client that may wait for a result at once.")
    max_memory: int = _setting(
        0,
        "Bytes that the hub may hold for all clients together: queues, incomplete and latched "
        "messages, files, recording; 0 for half of the memory of the machine or its container.",
    )
    max_queued_bytes: int = _setting(16 * MIB, "Bytes kept for one client that reads too slowly.")
    max_total_queued_bytes: int = _setting(
        512 * MIB, "Bytes kept for all clients that read too slowly together."
    )
    max_latched_bytes: int = _setting(
        64 * MIB, "Bytes that the latched messages of one client may take together."
    )
    max_fragment_bytes: int = _setting(
        64 * MIB, "Bytes kept of incomplete fragmented messages of one client."
    )
    max_total_incoming_bytes: int = _setting(
        512 * MIB, "Bytes kept of the incomplete messages of all clients together."
    )
    max_parameter_bytes: int = _setting(
        4 * MIB, "Bytes of JSON that all parameters may take together."
    )
    stall_timeout: float = _setting(
        30.0, "Seconds for which a client may stop reading before it is disconnected."
    )
    max_message_size: int = _setting(64 * MIB, "Bytes that one incoming message may have.")
    max_request_head: int = _setting(
        64 * KIB, "Bytes that a request's line and headers may have, cookies included."
    )
    deflate: Literal["auto", "always", "never"] = _setting(
        "auto",
        "Compression of long texts for rosbridge clients that offer permessage-deflate: auto "
        "(those of other machines), always or never.",
    )
    ping_interval: float = _setting(20.0, "Seconds between two pings; 0 sends none.")
    ping_timeout: float = _setting(
        20.0, "Seconds in which a client must answer a ping, or send anything else."
    )
    open_timeout: float = _setting(10.0, "Seconds in which a client must finish its handshake.")
    close_timeout: float = _setting(5.0, "Seconds in which a client must answer a close.")
    public_metrics: bool = _setting(
        False, "Let everybody read /metrics and all of /healthz, without the right admin."
    )
    drain: float = _setting(
        2.0, "Seconds over which clients are closed after SIGTERM; 0 closes all at once."
    )
    log_format: Literal["text", "json"] = _setting(
        "text", "Format of the log on stderr: text, or json, which is one object per line."
    )
    fast_framing: bool = _setting(
        True, "Parse whole messages directly, not through the websockets library."
    )

    @property
    def has_authentication(self) -> bool:
        """Whether clients must prove who they are."""
        return any((self.tokens, self.jwt_key, self.client_ca))

    def without_effect(self) -> list[SettingError]:
        """Return what is set but has no effect, as in ``--as has no effect without --join``."""
        found = []
        for name, others in _NEEDED.items():
            if self._is_set(name) and not any(map(self._is_set, others)):
                flags = " or ".join(f"--{_flag(each)}" for each in others)
                found.append(SettingError(f"--{_flag(name)} has no effect without {flags}"))
        return found

    def _is_set(self, name: str) -> bool:
        return bool(getattr(self, name) != self.__dataclass_fields__[name].default)

    def __new__(cls, *unnamed: Any, **values: Any) -> Settings:
        """Refuse unknown arguments, with the nearest known one."""
        if unnamed:
            raise TypeError(f"Settings takes named values, as in port=9090, got {unnamed[0]!r}")
        for name in values:
            if name not in cls.__dataclass_fields__:
                meant = suggestion(name, cls.__dataclass_fields__)
                raise TypeError(f"Settings has no argument {name}{meant}")
        return object.__new__(cls)

    def __post_init__(self) -> None:
        self._check_types()
        # As in URLs: [::1].
        object.__setattr__(self, "host", re.sub(r"^\[(.*:.*)\]$", r"\1", self.host))
        self._check_numbers()
        self._check_texts()
        if self.log_format not in LOG_FORMATS:
            raise SettingError(f"--log-format must be text or json, got {self.log_format}")
        if self.deflate not in DEFLATE:
            raise SettingError(f"--deflate must be {', '.join(DEFLATE)}, got {self.deflate}")
        self._check_tls()
        self._check_jwt()
        self._check_record()
        if self.keep_params and self.params is None:
            raise SettingError("--keep-params requires --params, the file to keep them in")
        self._check_join()
        self._check_addresses()
        self._check_endpoints()

    def _check_types(self) -> None:
        types = _types()
        for setting in fields(self):
            value, type_ = getattr(self, setting.name), types[setting.name]
            if not _fits(value, type_):
                wanted = getattr(type_, "__name__", None) if get_origin(type_) is None else type_
                raise SettingError(f"--{flag_of(setting)} must be {wanted or type_}, got {value!r}")

    def _check_numbers(self) -> None:
        for setting in fields(self):
            value = getattr(self, setting.name)
            if isinstance(value, int | float) and not 0 <= value < math.inf:
                raise SettingError(f"--{flag_of(setting)} must be >= 0 and finite, got {value}")
        for flag, port in (("port", self.port), ("ros1", self.ros1 or 0)):
            if port > 65535:
                raise SettingError(f"--{flag} must be between 0 and 65535, got {port}")

    def _check_texts(self) -> None:
        """Refuse what messages could not hold: bytes of the command line that are no characters."""
        for setting in fields(self):
            value = getattr(self, setting.name)
            values = value if isinstance(value, tuple) else (value,)
            is_shown = setting.name == "record"
            texts = [str(each) for each in values if isinstance(each, str) or is_shown]
            if any(map(_SURROGATE.search, texts)):
                flag = flag_of(setting)
                raise SettingError(f"--{flag} is not UTF-8; set a locale such as LANG=C.UTF-8")

    def _check_addresses(self) -> None:
        if not re.fullmatch(URL_PATH, self.url_path):
            raise SettingError(f"--url-path must be a path such as /robot, got {self.url_path}")
        if self.ros1_host and not _is_host(self.ros1_host):
            raise SettingError(f"--ros1-host must be a name or an address, got {self.ros1_host}")
        for network in self.trusted_proxy:
            parse_network(network, "--trusted-proxy")
        for network in self.ros1_allow:
            parse_network(network, "--ros1-allow")
        for origin in self.allow_origin:
            if not is_allowable(origin):
                raise SettingError(
                    "--allow-origin must be a scheme, a host and perhaps a port, such as "
                    f"https://lab.example, or null or *; got {origin}"
                )

    def _check_endpoints(self) -> None:
        for name in ("zenoh_listen", "zenoh", "ros2", "ros2_connect"):
            for endpoint in getattr(self, name):
                if endpoint == "auto" and name == "zenoh":
                    continue
                if not _is_endpoint(endpoint):
                    raise SettingError(
                        f"--{name.replace('_', '-')} must be an endpoint such as tcp/robot:7447, "
                        f"got {endpoint!r}"
                    )

    def _check_record(self) -> None:
        if self.record_compression not in COMPRESSIONS:
            raise SettingError(
                f"--record-compression must be {', '.join(COMPRESSIONS)}, "
                f"got {self.record_compression}"
            )
        if self.record_compression == ("bz2" if self.record_mcap else "zstd"):
            format_, others = (".mcap", "lz4, zstd") if self.record_mcap else (".bag", "bz2, lz4")
            raise SettingError(
                f"--record-compression must be none, {others} for {format_} files, "
                f"got {self.record_compression}"
            )

    @property
    def ros1_networks(self) -> list[Network]:
        """The networks whose ROS 1 nodes may join besides this machine."""
        return [parse_network(network, "--ros1-allow") for network in self.ros1_allow]

    @property
    def base_path(self) -> str:
        """The path of the hub's URLs, without a slash at its end; empty at the root."""
        return self.url_path.rstrip("/")

    @property
    def has_tls(self) -> bool:
        """Whether clients connect with TLS."""
        return self.cert is not None or self.self_signed

    def _check_join(self) -> None:
        for url in self.join:
            if not url.strip():
                raise SettingError("--join must be the address of a hub, got an empty text")
            try:
                hub_url(url)
                Credentials.find(url, environment={})
            except FibwsError as error:
                raise SettingError(f"--join: {error}") from None
        if self.join_prefix and not re.fullmatch(GLOBAL_NAME, self.join_prefix):
            raise SettingError(
                f"--as must be a global name such as /robot7, got {self.join_prefix}"
            )
        for namespace in self.share_params:
            if not re.fullmatch(GLOBAL_NAME, namespace):
                raise SettingError(
                    f"--share-params must be a global name such as /fleet, got {namespace}"
                )
        for flag, globs in (("export", self.join_export), ("import", self.join_import)):
            for glob in globs:
                try:
                    check_glob(glob)
                except AccessError as error:
                    raise SettingError(f"--{flag}: {error}") from None

    def _check_jwt(self) -> None:
        """Refuse to start without the authentication that was meant."""
        for name in ("jwt_algorithm", "jwt_audience", "jwt_leeway"):
            if self._is_set(name) and self.jwt_key is None:
                raise SettingError(f"--{_flag(name)} requires --jwt-key, the key of the tokens")

    def _check_tls(self) -> None:
        if self.cert is not None and self.key is None:
            raise SettingError("--cert requires --key, the private key of the certificate")
        if self.key is not None and self.cert is None:
            raise SettingError("--key requires --cert, the certificate of the key")
        if self.cert is not None and self.self_signed:
            raise SettingError("--self-signed and --cert exclude each other")
        if self.client_ca is not None and not self.has_tls:
            raise SettingError("--client-ca requires TLS: --cert and --key, or --self-signed")


def _flag(name: str) -> str:
    return flag_of(Settings.__dataclass_fields__[name])


@cache
def _types() -> dict[str, Any]:
    return get_type_hints(Settings)


def _fits(value: object, type_: Any) -> bool:
    """Return whether a value is of a setting's type; a whole number is a float, too."""
    origin, arguments = get_origin(type_), get_args(type_)
    if origin is Literal:
        return True  # Its own check names what is allowed.
    if origin is UnionType:
        return any(_fits(value, each) for each in arguments)
    if origin is tuple:
        return isinstance(value, tuple | list) and all(_fits(each, arguments[0]) for each in value)
    if type_ in (int, float):
        return isinstance(value, int | type_) and not isinstance(value, bool)
    return isinstance(value, type_)


def _is_endpoint(text: str) -> bool:
    found = re.fullmatch(ENDPOINT, text)
    if found is not None:
        return int(found[1]) < 65536
    return re.fullmatch(OTHER_ENDPOINT, text) is not None


def _is_host(text: str) -> bool:
    """Return whether a text is the name of a machine, or an IP address."""
    if re.fullmatch(r"[A-Za-z0-9_.-]+", text):
        return True
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True
