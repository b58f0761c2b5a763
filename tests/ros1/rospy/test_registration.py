"""A name that the hub will not have keeps no program from going on."""

from __future__ import annotations

from ros1.rospy.programs import running_hub


async def test_illegal_name_is_logged_and_the_program_continues() -> None:
    async with running_hub() as programs:
        program = await programs.start("""
            import rospy
            from std_msgs.msg import String
            from std_srvs.srv import Empty

            rospy.init_node("talker")
            chatter = rospy.Publisher("chit chat", String, queue_size=10)
            chatter.publish("nobody hears this")
            print(chatter.resolved_name, chatter.get_num_connections())
            for topic, kind in ("cheat chat", String), ("what ever", rospy.AnyMsg):
                print(rospy.Subscriber(topic, kind, print).get_num_connections())
            rospy.Service("go on", Empty, lambda request: {})
            try:
                rospy.ServiceProxy("go on", Empty)()
            except rospy.ServiceException as fault:
                print(fault)
        """)
        assert await program.finish() == [
            "/chit chat 0",
            "0",
            "0",
            "service [/go on] unavailable",
        ]
        for thing in (
            "publication [/chit chat]",
            "subscription [/cheat chat]",
            "subscription [/what ever]",
            "service [/go on]",
        ):
            assert f"unable to register {thing} with master: '/" in program.errors
        assert program.errors.count("[FATAL]") == 4
        assert "[ERROR]" not in program.errors
        assert "Traceback" not in program.errors
