"""What a network sees of a phone track and its sound: numbers for each frame and window."""

from lipwright.features.featureset import KINDS, FeatureSet
from lipwright.features.known import known_track, seen_phones

__all__ = ["KINDS", "FeatureSet", "known_track", "seen_phones"]
