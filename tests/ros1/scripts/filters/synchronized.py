#!/usr/bin/env python
import message_filters
import rospy
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header


def callback(image, info, word):
    print('%s %.1f %s' % (word, image.header.stamp.to_sec(), info.header.frame_id))
    if image.header.stamp.secs == 5:
        rospy.signal_shutdown('all have come')


if __name__ == '__main__':
    rospy.init_node('synchronized')
    images = message_filters.Subscriber('image', Image)
    infos = message_filters.Subscriber('camera_info', CameraInfo, queue_size=10)
    cache = message_filters.Cache(infos, 2)
    synchronizer = message_filters.TimeSynchronizer([images, infos], 10)
    synchronizer.registerCallback(callback, 'both')
    print(images.getTopic(), infos.resolved_name)

    image = rospy.Publisher('image', Image, queue_size=10)
    info = rospy.Publisher('camera_info', CameraInfo, queue_size=10)
    while not (image.get_num_connections() and info.get_num_connections()):
        rospy.sleep(0.05)
    for number in range(1, 6):
        image.publish(Image(header=Header(stamp=rospy.Time(number))))
        if number % 2:
            info.publish(CameraInfo(header=Header(stamp=rospy.Time(number), frame_id='camera')))
    rospy.spin()
    print([stamp.to_sec() for stamp in cache.cache_times])
