"""``python -m radhar_cli`` is the `radhar` program."""

from radhar_cli.cli import main

if __name__ == "__main__":
    main()
