"""How well a reference face gives back the recordings of a dataset.

    python bench/reference.py DATASET [--videos FOLDER] [--pictures FOLDER]

Fits to the train split, writes nothing into the dataset, and prints modes, round-trip errors and
what the joint modes keep of the lips' aperture on the test split. `--pictures` draws the pictures
of docs/reference-face.md, `--strip` frames of the first recording with the model laid over.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from lipwright.capture.face_of_dataset import load_takes
from lipwright.capture.face_pictures import draw_face, write_modes, write_vertices
from lipwright.capture.fit_face import FaceFit, fit_reference_face
from lipwright.capture.overlay import overlay_pictures
from lipwright.capture.takes import Take
from lipwright.dataset.folder import open_dataset
from lipwright.evaluate.lips import CLOSED
from lipwright.face.png import write_png
from lipwright.face.vertices import aperture

SHOWN = 10  # frames below the curves
STRIP = 6  # frames with the model laid over


def quiet(stage: str, share: float) -> None:
    pass


def print_modes(fit: FaceFit) -> None:
    shares = np.square(fit.face.shape_sd) / fit.face.info["modes"]["shape"]["variance"]
    print("shape modes, share of variance, cumulative:", *np.cumsum(shares).round(3))
    for name, found in fit.face.info["modes"].items():
        print(f"{name}: {found['modes']} modes hold {found['share']:.2%}")
    lights = np.stack(list(fit.lights.values()))
    print("light of the recordings, sd of red, green, blue:", *lights.std(axis=0).round(3))


def print_errors(fit: FaceFit) -> None:
    for split, errors in fit.face.info["errors"].items():
        for stage in ("shape", "appearance", "joint"):
            print(f"{split}, {stage}: {errors[stage]}")


def print_lips(fit: FaceFit, takes: list[Take]) -> None:
    """Aperture of the joint modes against the tracked, inside whole test recordings."""
    rs, kept, real = [], 0, 0
    for take in takes:
        tracked = aperture(take.shapes[take.valid])
        made = aperture(fit.face.to_shape(fit.face.join(fit.parameters[take.name])[take.valid]))
        rs.append(np.corrcoef(tracked, made)[0, 1])
        shut = tracked < CLOSED * np.percentile(tracked, 95)
        kept += int((made[shut] < CLOSED * np.percentile(made, 95)).sum())
        real += int(shut.sum())
    print(f"test, aperture through joint modes: r {np.mean(rs):.4f}, least {np.min(rs):.4f}; "
          f"shut frames that stay shut: {kept / max(real, 1):.2%} of {real}")  # fmt: skip


def write_clip_picture(path: Path, fit: FaceFit, take: Take, fps: float) -> None:
    """Tracked and modelled aperture of a recording, and below it the model's faces."""
    from matplotlib.figure import Figure

    y = fit.face.join(fit.parameters[take.name])
    times = (np.arange(len(take)) + 0.5) / fps
    chosen = np.linspace(0.2 * len(take), 0.8 * len(take), SHOWN).astype(int)
    figure = Figure(figsize=(11, 3.2), layout="constrained")
    grid = figure.add_gridspec(2, SHOWN, height_ratios=(1.3, 1))
    axes = figure.add_subplot(grid[0, :])
    axes.plot(times, aperture(take.shapes), color="#888888", linewidth=3, label="tracked")
    axes.plot(times, aperture(fit.face.to_shape(y)), color="#c0392b", linewidth=1, label="model")
    axes.set_xlabel("s")
    axes.set_ylabel("aperture")
    axes.legend(loc="upper right", fontsize=8)
    for column, frame in enumerate(chosen):
        axes.axvline(times[frame], color="#dddddd", linewidth=0.8, zorder=0)
        below = figure.add_subplot(grid[1, column])
        below.imshow(draw_face(fit.face, fit.face.split(y[frame])))
        below.set_title(f"{times[frame]:.2f} s", fontsize=7)
        below.set_axis_off()
    figure.savefig(path, dpi=100, metadata={"Software": None})


def write_strip(path: Path, fit: FaceFit, take: Take) -> None:
    """Frames of a recording, and below them the same with the model laid over."""
    light = fit.lights[take.name]
    pictures = list(overlay_pictures(fit.face, take, fit.parameters[take.name], light))
    height, width = pictures[0].shape[0], pictures[0].shape[1] // 2
    left, right = int(0.22 * width), int(0.78 * width)
    chosen = np.linspace(0.2 * len(pictures), 0.75 * len(pictures), STRIP).astype(int)
    tops = [pictures[frame][: int(0.8 * height), left:right] for frame in chosen]
    belows = [pictures[frame][: int(0.8 * height), width + left : width + right]
              for frame in chosen]  # fmt: skip
    strip = np.vstack([np.hstack(tops), np.hstack(belows)])
    write_png(path, np.ascontiguousarray(strip[::2, ::2]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--videos", type=Path)
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--strip", type=Path)
    options = parser.parse_args()
    dataset = open_dataset(options.dataset)
    takes, skipped = load_takes(dataset, options.videos, quiet)
    start = time.perf_counter()
    fit = fit_reference_face(takes)
    print(f"{len(takes)} recordings, {len(skipped)} skipped, {time.perf_counter() - start:.0f} s")
    test = [take for take in takes if take.split == "test"]
    print_modes(fit)
    print_errors(fit)
    if options.strip:
        write_strip(options.strip, fit, takes[0])
    if not test:
        return
    print_lips(fit, test)
    if options.pictures:
        write_modes(options.pictures / "reference-modes.png", fit.face)
        write_vertices(options.pictures / "reference-vertices.png", fit.face)
        fps = dataset.recording(test[0].name).motion.fps
        write_clip_picture(options.pictures / "reference-clip.png", fit, test[0], fps)


if __name__ == "__main__":
    main()
