"""onnxruntime, told to be quiet and to tell nobody what it runs."""

from __future__ import annotations

import os
from types import ModuleType
from typing import TYPE_CHECKING, Final, cast

if TYPE_CHECKING:
    from onnxruntime import InferenceSession

_FATAL: Final = 4  # onnxruntime's severity; what fails comes as an exception anyway


def import_onnxruntime() -> ModuleType:
    """onnxruntime, told before it is loaded to tell nobody what it runs.

    From 1.31 on it writes an identifier into the temporary folder while it is imported, to send
    usage metrics with.
    """
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime

    return cast(ModuleType, onnxruntime)


def open_session(content: bytes, threads: int | None = None) -> InferenceSession:
    """A session that runs the model in the bytes of an ONNX file on the processor.

    Args:
        content: of the file.
        threads: how many run one operation; None leaves it to onnxruntime.

    Raises:
        Exception: onnxruntime has a class for each kind of refusal, with no common one.
    """
    onnxruntime = import_onnxruntime()
    options = onnxruntime.SessionOptions()
    options.log_severity_level = _FATAL
    if threads is not None:
        options.intra_op_num_threads, options.inter_op_num_threads = threads, 1
    # Threads that spin while they wait made a run of 1 s last 40 s on a busy machine.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
