"""The rosbridge protocol: one endpoint of the hub's connections, which performs operations."""
