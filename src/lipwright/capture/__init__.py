"""Faces out of video: offline work, behind the extra `capture`."""
