"""The command line, ``fibws``: thin commands over the client, values and nodes."""
