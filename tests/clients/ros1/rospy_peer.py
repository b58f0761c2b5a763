"""A peer of the matrix in rospy, ROS's own or fibws's: rospy_peer.py NAME PEERS MESSAGES."""

import io
import json
import sys
import threading
from collections.abc import Callable
from typing import Any

import actionlib
import rospy
from actionlib.msg import TestAction, TestFeedback, TestGoal, TestResult
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Float64MultiArray, Int64MultiArray
from std_srvs.srv import SetBool, SetBoolResponse

TYPES: dict[str, Any] = {
    "ints": Int64MultiArray,
    "floats": Float64MultiArray,
    "image": CompressedImage,
}
LOCK = threading.Lock()
FINISH = threading.Event()
"""Set when a line of standard input lets the server finish its goal."""
GOAL_SECONDS = 10
"""The patience with a goal, which ROS's own actionlib may lose."""

name, peers, path = sys.argv[1:4]
with open(path) as file:
    MESSAGES = json.load(file)


def saw(what: str, peer: str, value: object) -> None:
    with LOCK:
        print(json.dumps({"saw": what, "of": peer, "value": value}), flush=True)


def message(kind: str) -> Any:
    return TYPES[kind]().deserialize(bytes.fromhex(MESSAGES[kind]["bytes"]))


def hear(what: str, peer: str, kind: str) -> None:
    heard: list[Any] = []

    def take(message: Any) -> None:
        if not heard:
            heard.append(message)
            buffer = io.BytesIO()
            message.serialize(buffer)
            saw(f"{what} {kind}", peer, buffer.getvalue().hex())

    rospy.Subscriber(f"/{peer}/{what}/{kind}", TYPES[kind], take)


def answer(request: Any) -> SetBoolResponse:
    if not request.data:
        raise rospy.ServiceException("refused by " + name)
    return SetBoolResponse(True, f"from {name}, \u00e4")


def execute(goal: Any) -> None:
    FINISH.clear()
    server.publish_feedback(TestFeedback(goal.goal))
    FINISH.wait()  # Feedback and result come on two connections, in any order.
    server.set_succeeded(TestResult(2 * goal.goal))


def call(peer: str) -> None:
    rospy.wait_for_service(f"/{peer}/set_bool")
    proxy = rospy.ServiceProxy(f"/{peer}/set_bool", SetBool)
    response = proxy(True)
    saw("service", peer, [response.success, response.message])
    try:
        proxy(False)
    except rospy.ServiceException:
        saw("refusal", peer, None)


def act(peer: str) -> None:
    client = actionlib.SimpleActionClient(f"/{peer}/act", TestAction)
    client.wait_for_server()
    feedback: list[int] = []

    def take(each: Any) -> None:
        feedback.append(each.feedback)
        saw("feedback", peer, each.feedback)

    client.send_goal(TestGoal(21), feedback_cb=take)
    if client.wait_for_result(rospy.Duration(GOAL_SECONDS)):
        saw("action", peer, [feedback, client.get_result().result])


def follow() -> None:
    for line in sys.stdin:
        if line == "finish\n":
            FINISH.set()
        else:
            start(act, line.strip())


def start(function: Callable[..., None], *arguments: str) -> None:
    threading.Thread(target=function, args=arguments, daemon=True).start()


rospy.init_node(name)
publishers = {}
for kind in TYPES:
    latched = rospy.Publisher(f"/{name}/latched/{kind}", TYPES[kind], latch=True, queue_size=1)
    latched.publish(message(kind))
    publishers[kind] = rospy.Publisher(f"/{name}/plain/{kind}", TYPES[kind], queue_size=1)
rospy.set_param("/parameters/" + name, MESSAGES["parameters"])
rospy.Service(f"/{name}/set_bool", SetBool, answer)
server = actionlib.SimpleActionServer(f"/{name}/act", TestAction, execute, auto_start=False)
server.start()
print("ready", flush=True)
sys.stdin.readline()
for peer in peers.split(","):
    for kind in TYPES:
        hear("latched", peer, kind)
        hear("plain", peer, kind)
    saw("parameters", peer, rospy.get_param("/parameters/" + peer))
for peer in MESSAGES["serving"]:
    start(call, peer)
start(follow)
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    for kind in TYPES:
        publishers[kind].publish(message(kind))
    rate.sleep()
