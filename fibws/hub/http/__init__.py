"""HTTP on the hub's port: which WebSockets may open, the page, files, and the login."""
