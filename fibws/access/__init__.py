"""Who may do what: principals, their rights, and the file of tokens."""
