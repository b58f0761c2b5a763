"""The node library: a node of the ROS graph in an asyncio program. `import fibws` for its API.

    Node ── Publisher, Subscription, Rosout ── Topics ─┐
         ── ServiceServer, Loggers ── Services ────────┼─ Session ── OutgoingQueue ─┬─ WebSocket
         ── Params, Graph ── Calls ────────────────────┤          ── FrameParser ───┘
         ── ActionServer, ActionClient ────────────────┘

Topics, Services, Calls, and each action's server or client are the session's handlers: they know
what the node has registered and which responses it waits for. The session outlives connections
(`connection`), which alone know sockets. `types` makes bytes and JSON of messages.

One message, from `Publisher.publish` to the socket and from the socket to ``async for``:

    Publisher.publish → _frame_of (bytes of MessageCodec.serialize behind the WebSocket
    header) → OutgoingQueue.put → WebSocket.write, or `_flush` at the end of the loop's turn
    WebSocket.buffer_updated → FrameParser.receive → Topics._on_binary → Subscription._offer
    ... Subscription.__anext__ → MessageCodec.deserialize
"""
