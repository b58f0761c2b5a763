"""The graph: nodes, topics, services, actions, parameters, types. No frames, no queues."""
