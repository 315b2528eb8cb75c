"""The default mesher."""
