"""Lessons: sizes on a line, the shrinking ball, the adaptive process, and what is shown now in words."""
