#!/usr/bin/env python
"""What scripts ask the modules of ROS's tools."""
import os
import tempfile

import rosnode
import rosparam
import rospy
import rosservice
import rostopic
from std_msgs.msg import Header, String
from std_srvs.srv import SetBool, SetBoolResponse


def answer(request):
    return SetBoolResponse(request.data, 'yes' if request.data else 'no')


def attempt(function, *args):
    try:
        print(function(*args))
    except Exception as error:
        print('%s: %s' % (type(error).__name__, error))


if __name__ == '__main__':
    rospy.init_node('tools')
    chatter = rospy.Publisher('chatter', String, queue_size=10, latch=True)
    headers = rospy.Publisher('/robot/header', Header, queue_size=20)
    service = rospy.Service('~switch', SetBool, answer)
    chatter.publish('hello')

    print('nodes')
    print('/tools' in rosnode.get_node_names(), rosnode.get_node_names('/nowhere'))
    print('/tools' in rosnode.get_node_names('/tools'))
    print(rosnode.rosnode_ping('/tools', max_count=1))
    print(rosnode.rosnode_ping('/nobody', max_count=1, verbose=True))
    print('/tools' in rosnode.rosnode_ping_all()[0])
    print(rosnode.kill_nodes(['/nobody']))
    print(rosnode.get_node_info_description('/tools'))

    print('topics')
    print(rostopic.get_topic_type('/chatter'))
    print(rostopic.get_topic_type('/nothing'), rostopic.get_topic_class('/nothing'))
    message_class, name, evaluate = rostopic.get_topic_class('/robot/header/stamp/secs')
    print(message_class is Header, name, evaluate(Header(stamp=rospy.Time(5))))
    print(rostopic.get_topic_type('/robot/header/colour'))
    print(rostopic.find_by_type('std_msgs/Header'))
    published, _ = rostopic.get_topic_list()
    print([each for each in published if each[0] == '/chatter'])
    hz = rostopic.ROSTopicHz(-1)
    hz.print_hz()
    heard = []

    def hear(message):
        hz.callback_hz(message)
        heard.append(message)

    subscriber = rospy.Subscriber(name, message_class, hear)
    while not headers.get_num_connections():
        rospy.sleep(0.05)
    rate = rospy.Rate(20)
    for _ in range(11):
        headers.publish(Header())
        rate.sleep()
    while len(heard) < 11:
        rospy.sleep(0.05)
    found = hz.get_hz()
    print(0 < found[0] < 30, found[4] > 5, hz.get_hz())

    print('services')
    print('/tools/switch' in rosservice.get_service_list())
    print(rosservice.get_service_list(namespace='/tools', include_nodes=True)[-1])
    print(sorted(rosservice.get_service_list(node='/tools')))
    print(rosservice.get_service_type('/tools/switch'), rosservice.get_service_type('/nothing'))
    print(rosservice.get_service_node('/tools/switch'), rosservice.get_service_node('/nothing'))
    print(rosservice.rosservice_find('std_srvs/SetBool'))
    print(rosservice.get_service_class_by_name('/tools/switch') is SetBool)
    attempt(rosservice.get_service_class_by_name, '/nothing')
    print(rosservice.get_service_args('/tools/switch'), rosservice.has_service_args('/tools/switch'))
    uri = rosservice.get_service_uri('/tools/switch')
    print(sorted(rosservice.get_service_headers('/tools/switch', uri).items()))
    attempt(rostopic.get_info_text, '/nothing')

    print('parameters')
    path = os.path.join(tempfile.mkdtemp(), 'robot.yaml')
    with open(path, 'w') as file:
        file.write('size: 3\nangle: deg(90)\nturn: rad(pi/2)\narm: {joints: [1, 2.5, a], open: true}\n')
        file.write('---\n_ns: gripper\nforce: 1.5\n')
    loaded = rosparam.load_file(path)
    print(loaded)
    print(rosparam.load_file(path, default_namespace='/robot')[1])
    rosparam.upload_params('/robot', {'size': 2, 'name': 'r2'})
    for params, namespace in rosparam.load_file(path, '/robot'):
        rosparam.upload_params(namespace, params)
    print(sorted(rosparam.get_param('/robot').items(), key=str))
    print(rosparam.list_params('/robot'))
    rosparam.set_param('/robot/arm', '{open: false}')
    rosparam.set_param_raw('/robot/text', 'three words here', verbose=True)
    print(sorted(rosparam.get_param('/robot/arm').items()), rospy.get_param('/robot/text'))
    rosparam.delete_param('/robot/arm')
    print(rospy.has_param('/robot/arm'), rospy.has_param('/robot/size'))
    attempt(rosparam.get_param, '/nothing')
    attempt(rosparam.delete_param, '/nothing')
    attempt(rosparam.load_file, '/nowhere/robot.yaml')
    attempt(rosparam.upload_params, '/', 3)
    rosparam.dump_params(None, '/robot/gripper')
    rosparam.dump_params(path, '/robot/gripper')
    print(rosparam.load_file(path))
    os.remove(path)
    os.rmdir(os.path.dirname(path))
