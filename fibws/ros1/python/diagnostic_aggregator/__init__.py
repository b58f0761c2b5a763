"""The program aggregator_node."""
