"""A rospy node that counts at 20 Hz on /start, and prints gaps in what comes back on /end."""

import rospy
from std_msgs.msg import Int64

last = None


def check(number):
    global last
    if last is None:
        print("first", number.data, flush=True)
    elif number.data != last + 1:
        print("lost", last + 1, "to", number.data - 1, flush=True)
    last = number.data
    if last % 10 == 0:
        print("arrived", last, flush=True)


rospy.init_node("counter")
publisher = rospy.Publisher("/start", Int64, queue_size=1000)
rospy.Subscriber("/end", Int64, check)
number = 0
while not rospy.is_shutdown():
    number += 1
    publisher.publish(number)
    rospy.rostime.wallsleep(0.05)  # The relays queue 10 messages.
