"""Exported networks: a model folder, checked, as a function of numbers (docs/models.md)."""

from lipwright.network.folder import find_model, shipped_models
from lipwright.network.meta import ModelMeta
from lipwright.network.runtime import Network, check_golden, load_network

__all__ = [
    "ModelMeta",
    "Network",
    "check_golden",
    "find_model",
    "load_network",
    "shipped_models",
]
