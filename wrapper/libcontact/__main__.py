"""``python -m libcontact`` and the command ``libcontact``: nothing is imported before Ctrl-C is minded."""


def main() -> int:
    """Run one command and return its exit code."""
    try:
        from .command import main as command

        return command()
    except KeyboardInterrupt:
        import sys

        print("interrupted", file=sys.stderr)
        return 130


if __name__ == "__main__":
    raise SystemExit(main())
