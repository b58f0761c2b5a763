"""``python -m fibws.listener``, a program of `fibws.programs`."""

from fibws.programs.listener import command

if __name__ == "__main__":
    command(prog_name="python -m fibws.listener")
