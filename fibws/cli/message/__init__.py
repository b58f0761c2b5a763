"""Messages as the command line has them: what they are made of, printed, read, picked from."""
