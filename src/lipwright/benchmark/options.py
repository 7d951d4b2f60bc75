"""What is asked of the benchmark."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class BenchmarkOptions:
    """Who takes part, and what they are measured on.

    Raises:
        ValueError: a number is out of range.
    """

    engines: tuple[str, ...] = ("all",)
    """names of entrants; `all` for those that `entrants.USUAL` lists, and the peers installed"""
    models: tuple[tuple[str, str], ...] = ()
    """name and model of further ones: a model's folder, or a bigram set's file"""
    curves: tuple[tuple[str, Path], ...] = ()
    """name and folder of further ones: a CSV file of curves for each recording"""
    face: Path | None = None
    """the reference face; by default that beside the dataset, DATASET-face.npz"""
    second_head: Path | None = None
    """landmark points of a second head, .npz, on which lips are measured too"""
    hold_out: tuple[str, ...] = ()
    """patterns of names of recordings with unseen words, for a second training without them"""
    hold_out_words: tuple[str, ...] = ()
    """words; recordings that say one are unseen too"""
    quick: bool = False
    """small networks and few passes: a try of the whole, whose figures mean little"""
    seed: int = 0
    """of trainings and intervals"""
    videos: int = 2
    """recordings of the test that are drawn side by side with the real mouth"""
    keep_curves: bool = False
    """write the curves of every entrant too"""
    licence: str = ""
    """of the models that are trained"""

    def __post_init__(self) -> None:
        """Check."""
        if not 0 <= self.seed < 2**31:
            raise ValueError(f"seed is {self.seed}, not 0 to {2**31 - 1}")
        if not 0 <= self.videos <= 100:
            raise ValueError(f"{self.videos} videos; give 0 to 100")
        if not self.engines and not self.models and not self.curves:
            raise ValueError("nobody takes part; name an engine")
