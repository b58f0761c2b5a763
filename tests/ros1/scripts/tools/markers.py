"""A marker with a menu, and its client."""

import threading

import rospy
from geometry_msgs.msg import Pose
from interactive_markers.interactive_marker_server import *
from interactive_markers.menu_handler import *
from visualization_msgs.msg import InteractiveMarkerControl

rospy.init_node("markers")
server = InteractiveMarkerServer("basic", "x", 10)
menu = MenuHandler()


class Messages:
    """What has arrived on a topic."""

    def __init__(self, topic, type_):
        self.changed = threading.Condition()
        self.found = []
        rospy.Subscriber(topic, type_, self.receive)

    def receive(self, message):
        with self.changed:
            self.found.append(message)
            self.changed.notify_all()

    def next(self, accepts):
        with self.changed:
            while True:
                while self.found:
                    message = self.found.pop(0)
                    if accepts(message):
                        return message
                assert self.changed.wait(30), "nothing has arrived"


updates = Messages("basic/update", InteractiveMarkerUpdate)
full = Messages("basic/update_full", InteractiveMarkerInit)
feedbacks = Messages("seen", InteractiveMarkerFeedback)
seen = rospy.Publisher("seen", InteractiveMarkerFeedback, queue_size=10)
client = rospy.Publisher("basic/feedback", InteractiveMarkerFeedback, queue_size=10)


def is_update(message):
    return message.type == InteractiveMarkerUpdate.UPDATE


def show(message):
    print(message.server_id, message.seq_num)
    for marker in message.markers:
        entries = [(each.id, each.parent_id, each.title) for each in marker.menu_entries]
        print("marker", marker.name, marker.header.frame_id, marker.pose.position.x, entries)
    for each in getattr(message, "poses", []):
        print("pose", each.name, each.header.frame_id, each.pose.position.x)
    print("erases", getattr(message, "erases", []))


def marker(name):
    found = InteractiveMarker(name=name, scale=1)
    found.header.frame_id = "map"
    found.controls.append(InteractiveMarkerControl(name="move"))
    return found


print(updates.next(lambda each: each.type == InteractiveMarkerUpdate.KEEP_ALIVE).seq_num)
show(full.next(lambda each: True))
print(server.erase("none"), server.setPose("none", Pose()), server.get("none"))
print(server.setCallback("none", print))
server.applyChanges()

doors = menu.insert("Doors")
front = menu.insert("front", parent=doors, callback=seen.publish)
print(menu.insert("lost", parent=99))
hidden = menu.insert("hidden")
print(menu.setVisible(hidden, False), menu.setVisible(99, False))
print(menu.setCheckState(front, MenuHandler.CHECKED), menu.getCheckState(front))
print(menu.getCheckState(99), menu.getTitle(front), menu.getTitle(99), menu.setCheckState(99, 1))

server.insert(marker("a"), seen.publish)
server.insert(marker("b"), seen.publish, InteractiveMarkerFeedback.BUTTON_CLICK)
print(menu.apply(server, "a"))
server.applyChanges()
show(updates.next(is_update))
show(full.next(lambda each: each.markers))

pose = Pose()
pose.position.x = 2.5
print(server.setPose("a", pose), server.get("a").pose.position.x)
server.applyChanges()
show(updates.next(is_update))
menu.setCheckState(front, MenuHandler.UNCHECKED)
print(menu.reApply(server))
server.applyChanges()
show(updates.next(is_update))

rospy.sleep(1.1)  # The real server accepts no feedback in a marker's first second.


def send(event, **fields):
    feedback = InteractiveMarkerFeedback(client_id="me", event_type=event, **fields)
    feedback.header.frame_id = "odom"
    client.publish(feedback)


while client.get_num_connections() == 0 or seen.get_num_connections() == 0:
    rospy.sleep(0.01)
send(InteractiveMarkerFeedback.MENU_SELECT, marker_name="a", menu_entry_id=front)
print("menu", feedbacks.next(lambda each: True).menu_entry_id)
send(InteractiveMarkerFeedback.MENU_SELECT, marker_name="a", menu_entry_id=99)
pose.position.x = 3.5
send(InteractiveMarkerFeedback.POSE_UPDATE, marker_name="a", pose=pose)
found = feedbacks.next(lambda each: True)
print("moved", found.marker_name, found.event_type, server.get("a").pose.position.x)
server.applyChanges()
show(updates.next(is_update))
send(InteractiveMarkerFeedback.BUTTON_CLICK, marker_name="b")
print("clicked", feedbacks.next(lambda each: True).marker_name)

print(server.erase("a"), server.get("a"))
server.applyChanges()
show(updates.next(is_update))
print(menu.apply(server, "a"))
server.clear()
server.applyChanges()
show(updates.next(is_update))
