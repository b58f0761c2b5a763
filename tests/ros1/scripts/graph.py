#!/usr/bin/env python3
import rospy
from std_msgs.msg import String

rospy.init_node('graph_node')
pub = rospy.Publisher('robot/chatter', String, queue_size=1)
sub = rospy.Subscriber('robot/chatter', String, lambda m: None)
while not (pub.get_num_connections() and sub.get_num_connections()):
    rospy.sleep(0.02)
print([each for each in rospy.get_published_topics() if 'robot/chatter' in each[0]])
print(rospy.get_published_topics('/robot'), rospy.get_published_topics('/nothing'))
master = rospy.get_master()
code, text, (pubs, subs, srvs) = master.getSystemState()
print(code)
print([each for each in pubs if 'robot/chatter' in each[0]], [each for each in subs if 'robot/chatter' in each[0]])
print(sorted(each for each in srvs if 'graph_node' in each[0]))
print(master.lookupNode('/nobody')[0], master.lookupNode('/graph_node')[0])
print(sorted(each for each in master.getTopicTypes()[2] if 'robot/chatter' in each[0]))
print(sub.get_num_connections(), pub.get_num_connections(), sub.name, sub.resolved_name, sub.type)
