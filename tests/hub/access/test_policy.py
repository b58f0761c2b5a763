"""The policy of a hub with authentication."""

from __future__ import annotations

from itertools import product
from typing import Any, get_args

import pytest

from fibws.access.rights import RIGHTS, Principal, Proof, Right, Rights
from fibws.hub.access.policy import AccessPolicy
from fibws.hub.errors import NotAllowed


def principal(name: str, *, proof: Proof = "token", **rights: Any) -> Principal:
    return Principal(name, Rights.parse(rights, name=name, where=name), proof=proof)


def enter(policy: AccessPolicy, node: str, owner: Principal, *, is_taken: bool = False) -> None:
    policy.enter(node, owner, is_chosen=True, is_taken=is_taken)


def test_node_has_the_rights_of_its_principal_while_it_lives() -> None:
    policy = AccessPolicy()
    enter(policy, "/a", principal("ann", allow={"publish": ["/x"]}))
    assert policy.may("/a", "publish", "/x")
    assert not policy.may("/a", "publish", "/y")
    assert not policy.may("/a", "subscribe", "/x")
    assert not policy.may("/b", "publish", "/x")
    policy.leave("/a")
    assert not policy.may("/a", "publish", "/x")


def test_client_without_a_principal_may_not_enter() -> None:
    with pytest.raises(NotAllowed):
        AccessPolicy().enter("/a", None, is_chosen=False, is_taken=False)


def test_name_of_a_living_node_is_its_principals() -> None:
    policy = AccessPolicy()
    ann, bob = principal("ann"), principal("bob", admin=True)
    enter(policy, "/a", ann)
    with pytest.raises(NotAllowed):
        enter(policy, "/a", bob, is_taken=True)
    assert not policy.is_admin("/a")
    enter(policy, "/a", ann, is_taken=True)
    policy.leave("/a")
    enter(policy, "/a", bob)


def test_names_that_a_principal_has_are_kept_for_it() -> None:
    ann = principal("ann", allow={"node": ["/ann/**", "/%n"]})
    everywhere = principal("eve", allow={"node": ["/**"]})
    bob, boss = principal("bob", deny={"node": ["/x"]}), principal("boss", admin=True)
    policy = AccessPolicy([ann, bob, boss, everywhere])
    for node, owner in (("/ann/arm", ann), ("/ann", ann), ("/free", bob), ("/ann/1", boss)):
        enter(policy, node, owner)
    enter(policy, "/ann/2", everywhere)
    for node, owner in (("/ann/leg", bob), ("/x", bob), ("/free2", ann)):
        with pytest.raises(NotAllowed) as raised:
            enter(policy, node, owner)
        assert (raised.value.right, raised.value.name) == ("node", node)
    # A name that the hub makes up is free for everybody.
    policy.enter("/client_1", ann, is_chosen=False, is_taken=False)
    policy.keep_names([])
    enter(policy, "/ann/leg", bob)


def test_tools_may_have_the_names_that_they_give_themselves() -> None:
    robot = principal("robot", allow={"node": ["/robot/**"]})
    everyone = principal("eve", allow={"node": ["/fibws_*"]})
    policy = AccessPolicy([robot, everyone])
    for node in ("/fibws_echo_12_345", "/robot/fibws_tool_1_2", "/page_0af3"):
        enter(policy, node, robot)
        enter(policy, node.replace("1", "2").replace("0", "3"), principal("bob"))
    with pytest.raises(NotAllowed):
        enter(policy, "/fibws_echo", robot)


IMPLIED: list[tuple[Right, str]] = [
    ("publish", "/rosout"),
    ("call", "/rosapi/topics"),
    ("call", "/rosapi/kill_node"),
    ("call", "/rosout/get_loggers"),
    ("call", "/ann/set_logger_level"),
    ("provide", "/ann/get_loggers"),
    ("provide", "/ann/set_logger_level"),
    ("param_read", "/use_sim_time"),
    ("param_read", "/run_id"),
]


@pytest.mark.parametrize(("right", "name"), IMPLIED)
def test_some_rights_are_implied_and_can_be_denied(right: Right, name: str) -> None:
    policy = AccessPolicy()
    enter(policy, "/ann", principal("ann"))
    enter(policy, "/bob", principal("bob", deny={right: [name]}))
    enter(policy, "/bob/x", principal("bob", deny={right: ["/bob/*"]}))
    assert policy.may("/ann", right, name)
    assert not policy.may("/bob", right, name)
    assert not policy.may("/bob/x", right, f"/bob/{name.rpartition('/')[2]}") or name == "/rosout"


def test_nothing_else_is_implied() -> None:
    policy = AccessPolicy()
    enter(policy, "/ann", principal("ann"))
    enter(policy, "/bob", principal("bob"))
    for right in RIGHTS:
        assert not policy.may("/ann", right, "/x")
    for right, name in (
        ("subscribe", "/rosout"),
        ("provide", "/rosapi/topics"),
        ("call", "/rosapi/set_logger_level"),
        ("call", "/bob/set_logger_level"),
        ("call", "/bob/get_loggers"),
        ("provide", "/bob/get_loggers"),
        ("param_write", "/use_sim_time"),
    ):
        assert not policy.may("/ann", right, name), (right, name)


def test_only_admins_set_the_log_levels_of_others() -> None:
    policy = AccessPolicy()
    enter(policy, "/ann", principal("ann", allow={"call": ["/**"]}))
    enter(policy, "/boss", principal("boss", admin=True))
    assert not policy.may("/ann", "call", "/rosapi/set_logger_level")
    assert policy.may("/boss", "call", "/rosapi/set_logger_level")
    assert (policy.is_admin("/ann"), policy.is_admin("/boss")) == (False, True)


def test_goals_are_cancelled_by_the_right_to_send_them() -> None:
    policy = AccessPolicy()
    enter(policy, "/ann", principal("ann", allow={"call": ["/move"]}))
    assert policy.may("/ann", "call", "/move/_action/cancel_goal")
    assert not policy.may("/ann", "call", "/other/_action/cancel_goal")


def test_nodes_of_one_principal_are_told_from_those_of_others() -> None:
    policy = AccessPolicy()
    ann, bob = principal("ann"), principal("bob")
    for node, owner in (("/a", ann), ("/b", ann), ("/c", bob)):
        enter(policy, node, owner)
    assert policy.is_same_owner("/a", "/b")
    assert not policy.is_same_owner("/a", "/c")
    assert not policy.is_same_owner("/a", "/rosapi")
    assert not policy.is_same_owner("/x", "/x")


@pytest.mark.parametrize(("proof", "other"), list(product(get_args(Proof), repeat=2)))
def test_principals_are_told_apart_by_their_proofs(proof: Proof, other: Proof) -> None:
    policy = AccessPolicy()
    enter(policy, "/a", principal("ros1", proof=proof))
    stranger = principal("ros1", proof=other)
    enter(policy, "/b", stranger)
    is_same = proof == other != "anonymous"
    assert policy.is_same_owner("/a", "/b") is is_same
    if is_same:
        enter(policy, "/a", stranger, is_taken=True)
    else:
        with pytest.raises(NotAllowed):
            enter(policy, "/a", stranger, is_taken=True)


def test_title_of_a_principal_says_who_has_named_it() -> None:
    titles = {proof: principal("ann", proof=proof).title for proof in get_args(Proof)}
    assert titles["token"] == titles["network"] == "ann"
    assert (titles["JWT"], titles["certificate"]) == ("ann (JWT)", "ann (certificate)")
