"""Others' lip sync from the package registry, run on our phone times under the same measures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
import numpy.typing as npt

from lipwright.clip import Clip, frame_times
from lipwright.errors import LipwrightError, MissingExtraError
from lipwright.track import PhoneTrack

EXTRA: Final = "bench"

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Peer:
    """A program of others."""

    name: str
    """short, safe as a file's name"""
    title: str
    """for people"""
    about: str
    """a sentence: what it is, with its source"""
    package: str
    """that is imported; of the extra `bench`"""
    animate: Callable[[PhoneTrack, float], Clip]
    """phones and frames a second to curves of ARKit's controls; raises what the package raises"""


def _openfacefx(track: PhoneTrack, fps: float) -> Clip:
    """As `openfacefx mfa --textgrid X --retarget arkit --fps FPS` does, without starting Python."""
    from openfacefx import PhonemeSegment, generate_from_alignment
    from openfacefx.retarget import PRESETS, retarget

    segments = [
        PhonemeSegment(phone if stress is None else f"{phone}{stress}", start, end)
        for (phone, start, end), stress in zip(track, track.stress, strict=True)
    ]
    made = retarget(generate_from_alignment(segments, fps=fps), PRESETS["arkit"])
    channels = (
        (channel.name, [(key.time, key.value) for key in channel.keys]) for channel in made.channels
    )
    return _keyed_clip(channels, frame_times(track.end, fps), fps)


def _keyed_clip(
    channels: Iterable[tuple[str, list[tuple[float, float]]]],
    times: Floats,
    fps: float,
) -> Clip:
    """A clip of channels of keys (s, weight), linear between them."""
    names: list[str] = []
    columns: list[Floats] = []
    for name, keys in channels:
        if keys:
            when, values = np.array(sorted(keys), np.float64).T
            names.append(name)
            columns.append(np.interp(times, when, values))
    values = np.stack(columns, axis=1) if columns else np.zeros((len(times), 0))
    return Clip(tuple(names), fps, np.asarray(values, np.float32))


PEERS: Final[Mapping[str, Peer]] = MappingProxyType({
    peer.name: peer for peer in (
        Peer(
            "openfacefx", "OpenFaceFX",
            "OpenFaceFX (MIT, from the package registry): visemes with rules of coarticulation, "
            "retargeted to ARKit's controls by its own table.",
            "openfacefx", _openfacefx,
        ),
    )
})  # fmt: skip
"""name to peer"""


def animate_peer(name: str, track: PhoneTrack, fps: float) -> Clip:
    """The curves of a peer for our phones with times, from 0 s to the end of the track.

    Raises:
        MissingExtraError: its package is not installed.
        LipwrightError: there is no such peer, or it fails.
    """
    if name not in PEERS:
        raise LipwrightError(f"no peer {name!r}; the peers are: {', '.join(PEERS)}")
    peer = PEERS[name]
    try:
        return peer.animate(track, fps)
    except LipwrightError:
        raise
    except ImportError as error:
        if (error.name or "").partition(".")[0] == peer.package:
            raise MissingExtraError(peer.title, EXTRA) from error
        raise LipwrightError(_failure(peer, track, error)) from error
    except Exception as error:  # whatever a program of others may raise
        raise LipwrightError(_failure(peer, track, error)) from error


def _failure(peer: Peer, track: PhoneTrack, error: Exception) -> str:
    reason = " ".join(str(error).split()) or type(error).__name__
    return (
        f"{peer.title} failed on a track of {len(track)} phones and {track.end:.2f} s: {reason}; "
        f"reinstall it with: pip install 'lipwright[{EXTRA}]', or leave {peer.name} out"
    )
