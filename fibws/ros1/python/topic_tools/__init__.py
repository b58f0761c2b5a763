"""Programs that pass on the messages of topics of any type: http://wiki.ros.org/topic_tools."""
