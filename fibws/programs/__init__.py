"""The programs that come with fibws: nodes that are started, such as by ``fibws run``.

    broadcaster, listener        the tutorial's first nodes
    turtlesim/, demo, demo_robot/  simulators, and `fibws demo`, which starts them
    tf_echo, tf_monitor, view_frames, static_transform_publisher, tf2_web_republisher
    web_video_server             images as MJPEG

Their options are those of `fibws.cli.node_program`.
"""
