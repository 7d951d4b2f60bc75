"""File > Import > Lipwright clip (.json): speech animation onto shape keys and bones.

What is selected is animated: meshes by the names of their shape keys, armatures by the names of
their bones. Works in Blender 4.2 and later.
"""

from pathlib import Path

import bpy
from bpy.props import BoolProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from .animate import Placing, animate
from .clipfile import ClipError, read_clip

bl_info = {
    "name": "Lipwright clips",
    "author": "The Lipwright authors",
    "version": (1, 0, 0),
    "blender": (4, 2, 0),
    "location": "File > Import > Lipwright clip (.json)",
    "description": "Speech animation onto shape keys and bones",
    "category": "Import-Export",
}

SHOWN = 12  # names that a report lists


class ImportClip(bpy.types.Operator, ImportHelper):
    """Put the curves of a Lipwright clip onto the selected objects."""

    bl_idname = "import_anim.lipwright"
    bl_label = "Import Lipwright clip"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012  # Blender reads it so

    filename_ext = ".json"
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})
    start: IntProperty(
        name="Start frame", default=1, description="Frame of the scene where the clip starts"
    )
    set_rate: BoolProperty(
        name="Set frame rate",
        default=False,
        description="Give the scene the clip's frame rate; otherwise the clip is fitted to the "
        "scene's, in time with the sound",
    )
    set_range: BoolProperty(
        name="Extend frame range", default=True, description="Let the scene last as long as it"
    )
    add_sound: BoolProperty(
        name="Add sound",
        default=True,
        description="Put the sound of the same name beside the file into the sequencer",
    )

    def execute(self, context):
        """Read, animate, report."""
        path = Path(self.filepath)
        try:
            clip = read_clip(path)
        except ClipError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        placing = Placing(self.start, self.set_rate, self.set_range, self.add_sound)
        done = animate(context, clip, path, placing)
        if not done.moved:
            self.report(
                {"ERROR"},
                f"{path.name}: nothing that is selected has shape keys or bones of the names "
                f"{listed(clip.curves)}; select the character, or retarget the clip to its rig",
            )
            return {"CANCELLED"}
        if done.missing:
            self.report({"WARNING"}, f"{path.name}: no shape key or bone: {listed(done.missing)}")
        if done.silent:
            self.report({"WARNING"}, f"{path.name}: without its sound: {done.silent}")
        self.report({"INFO"}, f"{path.name}: {len(done.moved)} of {len(clip.curves)} curves")
        return {"FINISHED"}


def listed(names):
    """Names for people, the first of them where there are many."""
    names = list(names)
    rest = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + rest


def _in_menu(menu, context):
    menu.layout.operator(ImportClip.bl_idname, text="Lipwright clip (.json)")


def register():
    """Add the operator and its place in the menu."""
    bpy.utils.register_class(ImportClip)
    bpy.types.TOPBAR_MT_file_import.append(_in_menu)


def unregister():
    """Take both away."""
    bpy.types.TOPBAR_MT_file_import.remove(_in_menu)
    bpy.utils.unregister_class(ImportClip)
