"""The bytes that the hub holds for clients, and their bound."""
