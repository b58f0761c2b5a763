#!/usr/bin/env python3
import rospy
from std_msgs.msg import String


class ChatterListener(rospy.SubscribeListener):
    def peer_subscribe(self, topic_name, topic_publish, peer_publish):
        print("a peer subscribed to topic [%s]" % topic_name)
        topic_publish(String("hello all"))
        peer_publish(String("welcome, you alone"))

    def peer_unsubscribe(self, topic_name, num_peers):
        print("a peer unsubscribed from topic [%s], %d left" % (topic_name, num_peers))
        if num_peers == 0:
            print("I have no friends")


rospy.init_node('notify_publisher', anonymous=True)
pub = rospy.Publisher("chatter", String, subscriber_listener=ChatterListener(), queue_size=10)
print("ready")
rospy.spin()
