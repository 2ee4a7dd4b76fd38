"""``python -m libcontact`` and the command ``libcontact``: all imports happen after Ctrl-C is
handled."""


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
