"""What one client does: its operations, performed on the graph."""
