"""How the hub is doing, for those who run it: health, metrics, and the service manager."""
