#!/usr/bin/env python3
import rospy

D, T = rospy.Duration, rospy.Time
print(T(1, 2), D(1, 2), repr(T(1, 2)), repr(D(-1, 5)))
print(T(1.5), T.from_sec(2.25), T.from_seconds(3), D.from_sec(-1.5), D(0.1))
print(T(10) - T(4), T(10) - D(4), T(10) + D(0, 5), D(3) - D(5), -D(2), abs(D(-2)))
print(D(3) * 2, D(3) * 0.5, D(3) / 2, D(7) // 2, D(7) % D(4), D(7) / D(2), D(3) * 2.5)
print(T(1) < T(2), D(1) >= D(1), T(1) == T(1, 0), T(1) != D(1), D(1) == D(1.0))
print(T(1, 2).to_sec(), T(1, 2).to_nsec(), T(3).to_time(), D(1, 5).to_nsec(), T().is_zero(), bool(D()))
print(T(secs=1, nsecs=2 * 10 ** 9 + 1), D(secs=-1, nsecs=10 ** 9), hash(T(1)) == hash(T(1)))
print(isinstance(T(), rospy.rostime.genpy.Time), T(5).secs, D(5, 7).nsecs)
for expression in ("T(-1)", "T(1) + T(1)", "D(1) + T(1)", "T(1) < 2", "D('1')", "T(1) * 2", "T(1, 'a')",
                   "T(1.5, 2)", "T(1) - 1", "D(1) + 1", "D(2) * 'a'", "T.now()", "rospy.sleep('a')"):
    try:
        print(expression, "=", repr(eval(expression)))
    except Exception as e:
        print(expression, type(e).__name__, e)
rospy.init_node('times')
now = T.now()
print(type(now).__name__, abs(now.to_sec() - rospy.get_time()) < 60, type(rospy.get_rostime()).__name__)
start = rospy.get_time()
rospy.sleep(0.05)
rospy.sleep(D(0.05))
rospy.sleep(-1)
rospy.sleep(0)
print(0.09 < rospy.get_time() - start < 60)
for hz in (0, -1, "a"):
    try:
        rospy.Rate(hz)
        print("ok", hz)
    except Exception as e:
        print(hz, type(e).__name__, e)
start = rospy.get_time()
rate = rospy.Rate(50)
for _ in range(10):
    rate.sleep()
print(0.15 < rospy.get_time() - start < 60, rate.remaining().to_sec() <= 0.02)
events = []
fired = []


def tick(event):
    events.append(event)
    if len(events) >= 3 and fired:
        timer.shutdown()
        rospy.signal_shutdown("three ticks")


timer = rospy.Timer(D(0.02), tick)
once = rospy.Timer(D(0.01), lambda event: fired.append(print("once")), oneshot=True)
rospy.spin()
print(len(events) >= 3, events[0].last_real, events[0].last_duration, events[1].last_real == events[0].current_real)
print(sorted(vars(events[0])))
