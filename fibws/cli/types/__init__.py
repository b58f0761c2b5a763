"""The types of messages, services and actions, as rosmsg and rossrv show them."""
