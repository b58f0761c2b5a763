"""Delivery to clients: bounded send queues, throttles, and frames shared by many. Bytes only."""
