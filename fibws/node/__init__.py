"""The node library: what a program is on the ROS graph. `import fibws` has its public names.

    Node ── Publisher, Subscription, Rosout ── Topics ─┐
         ── ServiceServer, Loggers ── Services ────────┼─ Session ── Outbox ── Connection ── the hub
         ── Params, Graph ── Calls ────────────────────┤
         ── ActionServer, ActionClient ────────────────┘

Topics, services, calls, and each action's server or client are the parts of the session: what the
node has registered and what it waits for. The session outlives the connection, which alone knows
sockets. The outbox between them keeps what is to be sent in order and in bounds.
"""
