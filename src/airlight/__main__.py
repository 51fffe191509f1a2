"""`python -m airlight` is the `airlight` command."""

from .app.cli import main

if __name__ == "__main__":
    main()
