"""Datasets: recordings of speaking faces, as folders of open files."""
