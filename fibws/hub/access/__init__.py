"""Who clients are, and what they may do: authentication, and the graph's policy."""
