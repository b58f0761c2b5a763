"""Quotas: what one client, the clients of one address, and those of one principal may take."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fibws.access.limits import Limits, network_of
from fibws.access.rights import Principal, Rights
from fibws.hub.errors import LimitReached
from fibws.hub.settings import Settings
from fibws.hub.websocket import quotas as module
from fibws.hub.websocket.endpoint import Registration
from fibws.hub.websocket.quotas import (
    BURST_SECONDS,
    LEAST_MESSAGES,
    SUSTAINED_SECONDS,
    ClientQuotas,
    Quotas,
    TokenBucket,
)


class Connection:
    """A client's connection, which has registered something."""

    def __init__(self, node: str = "", /, **registered: int) -> None:
        self.node = node
        self.registered = registered
        self.messages_received = 0

    def registrations(self, what: Registration) -> int:
        return self.registered.get(what, 0)


def principal(name: str = "ann", **limits: Any) -> Principal:
    return Principal(name, Rights(), limits=Limits(**limits))


def entered(
    quotas: Quotas, address: str = "10.0.0.1", connection: Connection | None = None
) -> ClientQuotas:
    client = ClientQuotas(quotas)
    client.join_address(connection or Connection(), address, 0.0)
    return client


# Rates.


@given(
    st.floats(0.1, 1e6),
    st.floats(0, 1000),
    st.lists(st.tuples(st.floats(0, 10), st.floats(0, 500)), max_size=50),
)
def test_bucket_admits_no_more_than_its_rate(
    rate: float, least: float, arrivals: list[tuple[float, float]]
) -> None:
    """What is admitted in any time is at most the rate, the burst and the last charge."""
    bucket = TokenBucket(rate, least, 0.0)
    now, empty_until, admitted = 0.0, 0.0, list[tuple[float, float]]()
    for pause, amount in arrivals:
        now += pause
        if now >= empty_until:
            empty_until = now + bucket.charge(amount, now)
            admitted.append((now, amount))
    for first, (began, _) in enumerate(admitted):
        total = 0.0
        for at, amount in admitted[first:]:
            most = bucket.burst + rate * (at - began)
            assert total <= most * (1 + 1e-9) + 1e-6
            total += amount


@given(st.floats(0.1, 1e6), st.lists(st.floats(0.01, 0.99), max_size=50))
def test_bucket_never_refuses_its_rate(rate: float, shares: list[float]) -> None:
    bucket = TokenBucket(rate, 0, 0.0)
    for number, share in enumerate(shares, 1):
        assert not bucket.charge(rate * share, float(number))


def test_empty_bucket_has_something_again_after_the_time_it_says() -> None:
    bucket = TokenBucket(10, LEAST_MESSAGES, 0.0)
    seconds = bucket.charge(LEAST_MESSAGES + 30, 0.0)
    assert seconds == 3.0
    assert bucket.charge(0, seconds - 0.1)
    assert not bucket.charge(0, seconds + 0.1)
    assert not bucket.is_full(seconds)
    assert bucket.is_full(seconds + LEAST_MESSAGES / 10)


def test_unlimited_client_is_not_measured() -> None:
    client = entered(Quotas(Settings()))
    client.join_principal(Connection(), principal(), 0.0)
    assert client.meter is None


@pytest.mark.parametrize("whose", ["", "address_", "principal_"])
@pytest.mark.parametrize(("what", "charge"), [("messages", (1001, 0)), ("bytes", (1, 100_001))])
def test_too_much_a_second_is_refused(whose: str, what: str, charge: tuple[int, int]) -> None:
    limit = {"messages": 500.0, "bytes": 50_000.0}[what]
    name = f"max_{whose}{what}_per_second"
    settings: dict[str, Any] = {name: limit}
    client = entered(Quotas(Settings(**settings)))
    client.join_principal(Connection(), principal(), 0.0)
    meter = client.meter
    assert meter is not None
    meter.charge(*charge, now=BURST_SECONDS)
    assert meter.refusal is not None
    assert f"limit {limit:g}, --{name.replace('_', '-')}" in meter.refusal
    assert len(meter.refusal.encode()) <= 123
    assert not meter.resumes(BURST_SECONDS)
    assert meter.resumes(BURST_SECONDS + 1)
    assert meter.refusal is None


def test_clients_of_one_address_share_its_rate() -> None:
    quotas = Quotas(Settings(max_address_messages_per_second=100))
    one, other, neighbour = (
        entered(quotas, address).meter for address in ("10.0.0.1", "10.0.0.1", "10.0.0.2")
    )
    assert one is not None
    assert other is not None
    assert neighbour is not None
    one.charge(200, 0, 0.0)
    other.charge(1, 0, 0.0)
    neighbour.charge(1, 0, 0.0)
    assert (other.refusal is None, neighbour.refusal is None) == (False, True)


def test_limits_of_a_token_take_precedence() -> None:
    quotas = Quotas(Settings(max_principal_messages_per_second=100))
    client = entered(quotas)
    client.join_principal(Connection(), principal(messages_per_second=0), 0.0)
    assert client.meter is None
    client = entered(quotas)
    client.join_principal(Connection(), principal("bob", messages_per_second=5), 0.0)
    assert client.meter is not None
    client.meter.charge(LEAST_MESSAGES + 1, 0, 0.0)
    assert "limit 5, limits.messages_per_second" in str(client.meter.refusal)


def test_client_is_beyond_a_limit_for_too_long_after_some_seconds_in_a_row() -> None:
    meter = entered(Quotas(Settings(max_messages_per_second=1))).meter
    assert meter is not None
    in_a_row = [meter.sweep(dropped) for dropped in range(1, SUSTAINED_SECONDS + 1)]
    assert in_a_row == [False] * (SUSTAINED_SECONDS - 1) + [True]
    assert not meter.sweep(SUSTAINED_SECONDS)  # Nothing was dropped in this second.
    assert not meter.sweep(SUSTAINED_SECONDS + 1)


def test_new_login_makes_no_excess_good() -> None:
    quotas, connection = Quotas(Settings()), Connection()
    client = entered(quotas, connection=connection)
    for dropped in range(1, SUSTAINED_SECONDS + 1):
        client.join_principal(connection, principal(messages_per_second=5 + dropped % 2), 0.0)
        assert client.meter is not None
        # Two limits have two buckets, which are empty from then on.
        client.meter.charge(LEAST_MESSAGES + 1 if dropped <= 2 else 1, 0, 0.0)
        assert client.meter.refusal is not None
        is_closed = client.meter.sweep(dropped)
    assert is_closed


def test_messages_before_there_was_a_limit_are_not_charged() -> None:
    quotas, connection = Quotas(Settings()), Connection()
    client = entered(quotas, connection=connection)
    connection.messages_received = 1_000_000
    client.join_principal(connection, principal(messages_per_second=5), 0.0)
    assert client.meter is not None
    assert client.meter.charged == 1_000_000


# Connections and registrations.


def test_connections_of_one_address_are_limited() -> None:
    quotas = Quotas(Settings(max_address_connections=2))
    connections = [Connection() for _ in range(3)]
    clients = [ClientQuotas(quotas) for _ in connections]
    for client, connection in zip(clients[:2], connections, strict=False):
        client.join_address(connection, "10.0.0.1", 0.0)
    with pytest.raises(LimitReached, match=r"limit 2, --max-address-connections"):
        clients[2].join_address(connections[2], "10.0.0.1", 0.0)
    clients[2].join_address(connections[2], "10.0.0.2", 0.0)
    clients[0].leave(connections[0])
    ClientQuotas(quotas).join_address(Connection(), "10.0.0.1", 0.0)


def test_node_that_connects_again_takes_its_own_place() -> None:
    """Its former connection may be broken without the hub knowing yet."""
    quotas = Quotas(Settings(max_principal_connections=1, max_address_connections=1))
    client, broken = ClientQuotas(quotas), Connection("/robot")
    client.join_address(broken, "10.0.0.1", 0.0, "/robot")
    client.join_principal(broken, principal(), 0.0, "/robot")
    for node in (None, "/other"):
        with pytest.raises(LimitReached):
            ClientQuotas(quotas).join_address(Connection(), "10.0.0.1", 0.0, node)
        with pytest.raises(LimitReached):
            ClientQuotas(quotas).join_principal(Connection(), principal(), 0.0, node)
    again = ClientQuotas(quotas)
    again.join_address(Connection(), "10.0.0.1", 0.0, "/robot")
    again.join_principal(Connection(), principal(), 0.0, "/robot")


def test_connections_of_one_principal_are_limited() -> None:
    quotas = Quotas(Settings(max_principal_connections=1))
    first, second = entered(quotas), entered(quotas)
    connection = Connection()
    first.join_principal(connection, principal(), 0.0)
    first.join_principal(connection, principal(), 0.0)  # With another token.
    with pytest.raises(LimitReached, match=r"limit 1, --max-principal-connections"):
        second.join_principal(Connection(), principal(), 0.0)
    second.join_principal(Connection(), principal("bob"), 0.0)
    first.join_principal(connection, principal("cid"), 0.0)
    entered(quotas).join_principal(Connection(), principal(), 0.0)


def test_proofs_of_one_principal_with_other_limits_count_together() -> None:
    quotas = Quotas(Settings())
    connections = [Connection(subscriptions=1) for _ in range(3)]
    few, many = (principal(connections=limit, subscriptions=limit) for limit in (2, 3))
    clients = [entered(quotas) for _ in connections]
    for client, connection in zip(clients[:2], connections, strict=False):
        client.join_principal(connection, many, 0.0)
    with pytest.raises(LimitReached, match=r"limit 2, limits\.connections"):
        clients[2].join_principal(connections[2], few, 0.0)
    clients[2].join_principal(connections[2], many, 0.0)
    clients[2].join_principal(connections[2], few, 0.0)  # It is connected already.
    with pytest.raises(LimitReached, match=r"limit 2, limits\.subscriptions"):
        clients[2].check_room("subscriptions")
    for client, connection in zip(clients, connections, strict=True):
        client.leave(connection)
    quotas.sweep(1.0)
    assert len(quotas) == 0


@pytest.mark.parametrize("what", ["subscriptions", "advertisements"])
def test_registrations_of_one_address_are_limited_together(what: Registration) -> None:
    settings: dict[str, Any] = {f"max_address_{what}": 3}
    quotas = Quotas(Settings(**settings))
    clients = [entered(quotas, connection=Connection(**{what: count})) for count in (1, 1)]
    clients[0].check_room(what)
    other = entered(quotas, connection=Connection(**{what: 1}))
    with pytest.raises(LimitReached, match=f"limit 3, --max-address-{what}"):
        other.check_room(what)
    entered(quotas, "10.0.0.2", Connection(**{what: 2})).check_room(what)


def test_changed_limits_of_a_principal_count_all_its_clients() -> None:
    quotas = Quotas(Settings())
    connections = [Connection(subscriptions=1) for _ in range(2)]
    clients = [entered(quotas), entered(quotas)]
    for limit in (5, 2):
        for client, connection in zip(clients, connections, strict=True):
            client.join_principal(connection, principal(subscriptions=limit), 0.0)
    for client in clients:
        with pytest.raises(LimitReached, match="limit 2"):
            client.check_room("subscriptions")


# Handshakes, and memory.


def test_handshakes_of_one_address_are_limited() -> None:
    quotas = Quotas(Settings(max_address_handshakes_per_second=100))
    refusals = [quotas.handshake_refusal("10.0.0.1", 0.0) for _ in range(201)]
    assert refusals[:200] == [None] * 200
    assert "limit 100, --max-address-handshakes-per-second" in str(refusals[200])
    assert quotas.handshake_refusal("10.0.0.2", 0.0) is None
    assert quotas.handshake_refusal("10.0.0.1", 1.0) is None


def test_address_that_goes_on_asking_gets_its_rate() -> None:
    """Refused requests are free: otherwise clients that retry would never come in again."""
    quotas = Quotas(Settings(max_address_handshakes_per_second=1))
    refusals = [quotas.handshake_refusal("10.0.0.1", number / 10) for number in range(10_000)]
    assert LEAST_MESSAGES + 990 <= refusals.count(None) <= LEAST_MESSAGES + 1000


def test_thousand_clients_of_one_machine_may_reconnect_at_once() -> None:
    quotas = Quotas(Settings())
    assert not any(quotas.handshake_refusal("10.0.0.1", 0.0) for _ in range(1000))


def test_addresses_and_principals_that_are_gone_are_forgotten() -> None:
    quotas = Quotas(
        Settings(max_address_messages_per_second=10, max_principal_messages_per_second=10)
    )
    connection = Connection()
    client = ClientQuotas(quotas)
    client.join_address(connection, "10.0.0.1", 0.0)
    client.join_principal(connection, principal(), 0.0)
    assert quotas.handshake_refusal("10.0.0.1", 0.0) is None
    assert client.meter is not None
    client.meter.charge(LEAST_MESSAGES, 0, 0.0)
    quotas.sweep(100.0)
    assert len(quotas) == 2  # The client is still connected.
    client.leave(connection)
    client.leave(connection)
    client.meter.charge(LEAST_MESSAGES, 0, 100.0)
    quotas.sweep(101.0)
    assert len(quotas) == 2  # Otherwise it would connect again, and have its burst again.
    quotas.sweep(200.0)
    assert len(quotas) == 0


def test_addresses_are_remembered_up_to_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_IDLE", 10)
    quotas = Quotas(Settings(max_address_messages_per_second=10))
    for number in range(100):
        address = f"10.0.0.{number}"
        assert quotas.handshake_refusal(address, 0.0) is None
        connection, client = Connection(), ClientQuotas(quotas)
        client.join_address(connection, address, 0.0)
        assert client.meter is not None
        client.meter.charge(1, 0, 0.0)
        client.leave(connection)
    quotas.sweep(0.0)
    assert len(quotas) <= 20


def test_busy_address_is_remembered_longer_than_an_idle_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "MOST_IDLE", 10)
    quotas = Quotas(Settings(max_address_handshakes_per_second=1))
    refusals = []
    for number in range(LEAST_MESSAGES + 1):
        refusals.append(quotas.handshake_refusal("10.0.0.1", 0.0))
        assert quotas.handshake_refusal(f"10.0.1.{number}", 0.0) is None
    assert [refusal is None for refusal in refusals] == [True] * LEAST_MESSAGES + [False]


@pytest.mark.parametrize(
    ("address", "network"),
    [
        ("10.0.0.1", "10.0.0.1"),
        ("::ffff:10.0.0.1", "10.0.0.1"),
        ("2001:db8:1:2:3::4", "2001:db8:1:2::/64"),
        ("fe80::1%eth0", "fe80::/64"),
        ("unknown", "unknown"),
        ("", ""),
    ],
)
def test_network_of_an_ipv6_address_counts_as_one(address: str, network: str) -> None:
    assert network_of(address) == network
