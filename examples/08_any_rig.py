"""One performance on every character: retargeted to several rigs, in formats of their programs.

python examples/08_any_rig.py [CURVES]

CURVES is a clip of canonical controls, such as a JSON of `lipwright animate`.
"""

import sys
from pathlib import Path

import numpy as np
from crab.model import crab

from lipwright.export import ExportOptions, export_all
from lipwright.export.rigged import for_rig
from lipwright.export.stored import read_performance
from lipwright.rig import load_rig

here = Path(__file__).parent
curves = Path(sys.argv[1]) if len(sys.argv) > 1 else here / "hello.clip.json"
out = Path("demo")
out.mkdir(exist_ok=True)

# A rig that ships or a rig's file, and what its characters are played with.
TARGETS = {
    "vrm1": ["vrm.vrma", "vrm.anim"],  # any VRM 1.0 avatar; Unity
    "oculus": ["oculus.tres"],  # Godot
    "facefx": ["facefx.unreal.csv"],
    "bones": ["bones.glb", "bones.bvh"],
    "rhubarb": ["drawn.rhubarb.tsv", "drawn.spine.json"],
    here / "crab" / "crab.rig.json": ["crab-rig.glb"],
}

performance = read_performance(curves, audio=here / "hello.flac")
for target, files in TARGETS.items():
    rig = load_rig(target)
    moved = for_rig(performance, rig)
    few = ExportOptions(keys=0.01, character=crab() if rig.name == "crab" else None)
    export_all([out / file for file in files], moved, options=few)
    moving = sum(len(np.unique(moved.clip.curve(control))) > 1 for control in rig.names)
    print(f"{rig.name:8}{moving:3} of {len(rig.names):2} controls move: {', '.join(files)}")
