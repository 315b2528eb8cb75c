"""Panes: a flat picture with its controls, and the board that keeps several of them together."""
