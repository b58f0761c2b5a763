"""Checks of a device, and what is published of them."""

import threading

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from diagnostic_updater import *
from std_msgs.msg import Header
from geometry_msgs.msg import PointStamped

rospy.init_node("device")
arrays = []
arrived = threading.Condition()


def receive(array):
    with arrived:
        arrays.append(array)
        arrived.notify_all()


def show(*, numbers=True):
    """Print the next array."""
    with arrived:
        while not arrays:
            assert arrived.wait(30), "nothing has arrived"
        array = arrays.pop(0)
    print(array.header.stamp > rospy.Time(0))
    for status in array.status:
        print(status.level, repr(status.name), repr(status.message), repr(status.hardware_id))
        for each in status.values:
            varies = "Duration" in each.key or "Actual" in each.key or " delay:" in each.key
            print("  ", repr(each.key), "..." if varies else repr(each.value))


updater = Updater()
rospy.Subscriber("/diagnostics", DiagnosticArray, receive)
while updater.publisher.get_num_connections() == 0:
    rospy.sleep(0.01)


def check(stat):
    stat.summary(WARN, "hot")
    stat.add("Temperature", 81.5)
    stat.add("Fans", None)
    return stat


updater.add("Temperature", check)
show()
updater.force_update()
show()
updater.setHardwareID("serial 7")
both = CompositeDiagnosticTask("Both")
both.addTask(FunctionDiagnosticTask("one", lambda stat: (stat.summary(OK, "fine"), stat)[1]))
both.addTask(FunctionDiagnosticTask("two", check))
both.addTask(FunctionDiagnosticTask("three", lambda stat: (stat.summary(ERROR, "gone"), stat)[1]))
both.addTask(DiagnosticTask("four"))
updater.add(both)
show()
updater.add(Heartbeat())
show()
updater.force_update()
show()
print(updater.removeByName("Temperature"), updater.removeByName("Temperature"))
updater.broadcast(ERROR, "unplugged")
show()

bounds = {"min": 0.001, "max": 1e9}
topic = DiagnosedPublisher(
    rospy.Publisher("points", PointStamped, queue_size=1),
    updater,
    FrequencyStatusParam(bounds, 0.1, 10),
    TimeStampStatusParam(),
)
show()
updater.force_update()
show()
for stamp in (rospy.Time.now(), rospy.Time.now() - rospy.Duration(100), rospy.Time()):
    topic.publish(PointStamped(header=Header(stamp=stamp)))
    updater.force_update()
    show()
topic.publish(PointStamped(header=Header(stamp=rospy.Time.now() + rospy.Duration(100))))
topic.publish(PointStamped(header=Header(stamp=rospy.Time())))
updater.force_update()
show()
topic.clear_window()
updater.force_update()
show()

for low, high in ((1e6, 1e7), (1e-9, 1e-8), (5.0, 5.0), (0.0, None)):
    bounds = {"min": low} if high is None else {"min": low, "max": high}
    status = FrequencyStatus(FrequencyStatusParam(bounds))
    rospy.sleep(0.01)
    status.tick()
    stat = status.run(DiagnosticStatusWrapper())
    print(stat.level, stat.message)
    print([each.key for each in stat.values], [each.value for each in stat.values[4:]])

stat = DiagnosticStatusWrapper(level=OK, message="a")
for level, message in ((OK, "b"), (OK, ""), (WARN, "c"), (OK, "d"), (ERROR, "e"), (WARN, "f")):
    stat.mergeSummary(level, message)
    print(stat.level, repr(stat.message))
stat.clearSummary()
print(stat.level, repr(stat.message))
updater.period = 1
updater.update()
print(len(arrays))
