"""``python -m clepsydra``: the command line, where no command is on the path."""

from clepsydra.cli import main

if __name__ == "__main__":
    main()
