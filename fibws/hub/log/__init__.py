"""The hub's log, and its audit events."""
