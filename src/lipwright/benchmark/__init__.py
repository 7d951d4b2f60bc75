"""The benchmark: every engine on the held-out recordings of a dataset, and a report of it."""
