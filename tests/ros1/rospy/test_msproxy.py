"""The hub as a substitute for ROS's master."""

from __future__ import annotations

from ros1.rospy.programs import running_hub


async def test_proxy_answers_like_the_master() -> None:
    async with running_hub() as programs:
        said = await programs.run(
            """
            import rospy
            master = rospy.get_master()
            print(master is rospy.get_master(), master.getParam("/run_id")[0])
            rospy.init_node("asker")
            print(master.setParam("x", 5), master.getParam("x"), master.hasParam("x"))
            print(master.getParam("nope"))
            print(master.searchParam("~x"))
            print(master.lookupNode("nobody"))
            print(master.getPid()[0], master.getUri()[2])
            code, text, (publishers, subscribers, services) = master.getSystemState()
            print(code, "/robot/asker" in dict(publishers)["/rosout"])
            print(["/robot/asker/get_loggers", ["/robot/asker"]] in services)
            master["y"] = {"a": 1}
            print(master["y"], "y" in master, "/robot/y/a" in list(master))
            del master["y"]
            print("y" in master)
            try:
                master.nothing()
            except AttributeError as error:
                print(error)
            """,
            "__ns:=/robot",
        )
        assert said == [
            "True 1",
            "(1, '', 0) (1, '', 5) (1, '', True)",
            "(-1, 'Parameter [/robot/nope] is not set', 0)",
            "(-1, 'Cannot find parameter [/robot/asker/x] in an upwards search', 0)",
            "(-1, 'unknown node [/robot/nobody]', 0)",
            f"1 {programs.hub.url}",
            "1 True",
            "True",
            "{'a': 1} True True",
            "False",
            "'_Master' object has no attribute 'nothing'",
        ]


async def test_proxy_answers_after_shutdown() -> None:
    async with running_hub() as programs:
        said = await programs.run("""
            import rospy
            rospy.init_node("asker")
            rospy.set_param("~x", 5)
            rospy.signal_shutdown("enough")
            print(rospy.get_param("~x"), rospy.get_param("nope", 3))
            rospy.delete_param("~x")
            print(rospy.has_param("/asker/x"))
        """)
        assert said == ["5 3", "False"]
