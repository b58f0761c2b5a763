"""TLS: the hub's certificate, also one that it makes itself."""
