"""The command line: one verb a job, files in, files out, `-` for pipes.

Exit status: 0 done, 1 interrupted or failed inside, 2 something that the user gave or lacks.
"""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType

OK, FAILED, BAD_INPUT = 0, 1, 2


def _terminate(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt  # so that a kill cleans up as Ctrl-C does


def _complain(message: str) -> None:
    line = " ".join(message.split())
    print(f"lipwright: {line}", file=sys.stderr)  # noqa: T201  # this is the one place for it


def main() -> None:
    """Run the command line and end with its exit status."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:  # noqa: PLR0911  # one way out a kind of end
    """Run the command line on `arguments`; the exit status."""
    # Our matrices are small: a second thread of OpenBLAS costs more than it gives.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    import click

    from lipwright.cli.app import app
    from lipwright.errors import LipwrightError

    signal.signal(signal.SIGTERM, _terminate)
    try:
        result = app.main(arguments, prog_name="lipwright", standalone_mode=False)
    except LipwrightError as error:
        _complain(str(error))
        return BAD_INPUT
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return BAD_INPUT
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        path = context.command_path if context is not None else "lipwright"
        _complain(f"{error.format_message()} See '{path} --help'.")
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of our output has left; nothing more can be said to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except (KeyboardInterrupt, click.Abort):
        _complain("interrupted; nothing was written")
        return FAILED
    except Exception as error:  # a bug of ours: one line for the user
        if os.environ.get("LIPWRIGHT_DEBUG"):
            raise
        _complain(
            f"failed inside ({type(error).__name__}: {error}); this is a bug: "
            "run again with LIPWRIGHT_DEBUG=1 and report what it prints"
        )
        return FAILED
    return int(result) if isinstance(result, int) else OK
