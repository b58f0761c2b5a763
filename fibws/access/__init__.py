"""Access rights: principals, their rights and limits, and the file of tokens."""
