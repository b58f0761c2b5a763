#!/usr/bin/env python
"""Feeds filters with random messages, and prints what comes through."""
import random

import message_filters
import rospy
from sensor_msgs.msg import Image
from std_msgs.msg import Header, String


def stamped(seconds):
    return Image(header=Header(stamp=rospy.Time.from_sec(seconds)))


def show(*messages):
    print(' '.join('%.2f' % message.header.stamp.to_sec() for message in messages))


def feed(kind, make, count, spread):
    chance = random.Random(kind)
    filters = [message_filters.SimpleFilter() for _ in range(count)]
    synchronizer = make(filters)
    synchronizer.registerCallback(show)
    print(kind)
    for number in range(300):
        seconds = 100 + number // 10 * 0.1 + chance.randrange(spread) / 100.0
        chance.choice(filters).signalMessage(stamped(seconds))
    print([len(queue) for queue in synchronizer.queues])


if __name__ == '__main__':
    rospy.init_node('fed', anonymous=True)
    exact = message_filters.TimeSynchronizer
    about = message_filters.ApproximateTimeSynchronizer
    feed('exact, two', lambda fs: exact(fs, 10), 2, 3)
    feed('exact, three', lambda fs: exact(fs, 4), 3, 3)
    feed('exact, one', lambda fs: exact(fs, 1), 1, 1)
    feed('about, two', lambda fs: about(fs, 10, 0.05), 2, 20)
    feed('about, three', lambda fs: about(fs, 5, 0.1), 3, 30)
    feed('about, no slop', lambda fs: about(fs, 5, 0), 2, 2)
    feed('about, short queue', lambda fs: about(fs, 1, 0.2, reset=True), 2, 30)

    print('cache')
    source = message_filters.SimpleFilter()
    cache = message_filters.Cache(source, 5)
    print(cache.getLast(), cache.getLatestTime(), cache.getOldestTime())
    cache.registerCallback(lambda message, word: print(word), 'through')
    for seconds in (1, 2, 3, 3, 4, 5, 6):
        source.signalMessage(stamped(seconds))
    source.signalMessage(String('no header'))
    show(*cache.getInterval(rospy.Time(3), rospy.Time(5)))
    show(cache.getElemAfterTime(rospy.Time(4)), cache.getElemBeforeTime(rospy.Time.from_sec(4.5)))
    print(cache.getElemAfterTime(rospy.Time(7)), cache.getElemBeforeTime(rospy.Time(2)))
    print(cache.getLatestTime(), cache.getOldestTime())
    show(cache.getLast())
    show(*cache.cache_msgs)

    print('without headers')
    words = [message_filters.SimpleFilter() for _ in range(2)]
    synchronizer = about(words, 10, 10.0, allow_headerless=True)
    synchronizer.registerCallback(lambda *messages: print([each.data for each in messages]))
    for word in ('a', 'b'):
        for number, each in enumerate(words):
            each.signalMessage(String('%s%d' % (word, number)))
    strict = about(words, 10, 10.0)
    words[0].signalMessage(String('c'))
