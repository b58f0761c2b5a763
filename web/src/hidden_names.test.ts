import { expect, test } from "vitest";

import { isHidden } from "./hidden_names";

test.each([
  "/rosout",
  "/rosout_agg",
  "/rosapi/topics",
  "/client_count",
  "/page_0a1b2c3d",
  "/fibws_tool_4711_1700000000000",
  "/robot/fibws_doctor_4711_1700000000000",
  "/talker/set_logger_level",
  "/rosbridge_websocket/get_loggers",
  "/talker/get_loggers",
  "/robot7/rosout",
  "/robot7/rosout/cloud_0a1b2c",
])("%s is hidden", (name) => expect(isHidden(name)).toBe(true));

test.each([
  "/talker",
  "/rosout_of_mine",
  "/pages",
  "/robot/statistics",
  "/browser_0a1b2c3d",
  "/fibws_node",
  "/fibws_pub_4711_1700000000000",
])("%s is shown", (name) => expect(isHidden(name)).toBe(false));
