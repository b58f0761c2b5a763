"""The node library: what a program is on the ROS graph. `import fibws` has its public names.

    Node ── Publisher, Subscription, Rosout ── Session ── Outbox ── Connection ── the hub

The session is what the node has registered, and outlives the connection, which alone knows sockets.
The outbox between them keeps what waits in order and in bounds.
"""
