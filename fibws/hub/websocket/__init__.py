"""WebSocket connections and HTTP requests on the hub's port. Knows endpoints, not operations."""
