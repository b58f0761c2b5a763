"""The programs map_server and map_saver."""
