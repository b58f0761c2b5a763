"""The hub's own nodes: what it tells about its graph, its parameters, its log and its clients."""
