"""``python -m ncgear``: the command line."""

from ncgear.cli import main

if __name__ == "__main__":
    main()
