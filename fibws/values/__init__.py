"""Values of messages and parameters: their text, their fields, expressions on them."""
