"""A name that the hub will not have keeps no program from going on."""

from __future__ import annotations

from ros1.rospy.programs import world


async def test_a_name_that_is_not_legal_is_logged_and_the_program_goes_on() -> None:
    async with world() as it:
        program = await it.start("""
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
        assert await program.ends() == [
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
            assert f"unable to register {thing} with master: '/" in program.complaints
        assert program.complaints.count("[FATAL]") == 4
        assert "[ERROR]" not in program.complaints
        assert "Traceback" not in program.complaints
