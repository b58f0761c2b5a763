"""A synchronous client of a hub, for tools and scripts."""
