"""The head: its mesh, its blendshapes and its pictures."""
