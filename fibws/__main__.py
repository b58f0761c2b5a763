"""``python -m fibws``: the command line."""

from fibws.cli import main

if __name__ == "__main__":
    main()
