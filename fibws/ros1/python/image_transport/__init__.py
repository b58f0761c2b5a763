"""Images in compressed forms, and the program republish."""
