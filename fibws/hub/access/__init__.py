"""Authentication of clients, and the graph's policy."""
