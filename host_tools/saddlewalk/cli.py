"""The `saddlewalk` command: one module per subcommand in `saddlewalk.commands`."""

import argparse
import importlib
import os
import pkgutil
import signal
import sys
from typing import NoReturn

from saddlewalk import __version__, commands
from saddlewalk.errors import UserError
from saddlewalk.outputs import check_files
from saddlewalk.printable import printable


class _Parser(argparse.ArgumentParser):
    """Reports a wrong option in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {printable(message)} (see {self.prog} --help)\n")


def parser() -> argparse.ArgumentParser:
    root = _Parser(
        prog="saddlewalk",
        description="Plan a walk and score its stability with the embedded core, live or offline.",
    )
    root.add_argument("--version", action="version", version=f"saddlewalk {__version__}")
    subparsers = root.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for module in pkgutil.iter_modules(commands.__path__):
        importlib.import_module(f"saddlewalk.commands.{module.name}").add_parser(subparsers)
        command = subparsers.choices[module.name]
        command.set_defaults(parser=command)
    return root


def _end_cleanly() -> None:
    """SIGTERM and SIGHUP end a command as Ctrl-C does: the firmware is stopped, logs are closed."""
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)


def _forget_output() -> None:
    """Discard what standard output still buffers, since it cannot be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def main(argv: list[str] | None = None) -> int:
    """Run one subcommand. 0: done and sound; 1: done, and the result is bad; 2: bad input."""
    args = parser().parse_args(argv)
    _end_cleanly()
    try:
        if sys.stdout is None:
            raise UserError("standard output is closed: give one, such as /dev/null")
        check_files(args.parser, args)
        status = args.run(args)
        sys.stdout.flush()
        return status
    except UserError as error:
        print(f"saddlewalk {args.command}: {printable(error)}", file=sys.stderr)
        return 2
    except BrokenPipeError:
        _forget_output()
        return 1
    except (
        OSError
    ) as error:  # not handled by the command, such as a full disk under standard output
        print(f"saddlewalk {args.command}: {printable(error)}", file=sys.stderr)
        _forget_output()
        return 2
    except KeyboardInterrupt:
        return 130
