"""``python -m fibws.broadcaster``, a program of `fibws.programs`."""

from fibws.programs.broadcaster import command

if __name__ == "__main__":
    command(prog_name="python -m fibws.broadcaster")
