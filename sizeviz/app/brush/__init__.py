"""Painting in the window: the stroke under way, the brush's settings, the ring cursor."""
