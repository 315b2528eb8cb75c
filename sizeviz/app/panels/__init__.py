"""The panels of the pipeline, in its order: source, paint, size, mesh, smooth, judge. They emit intents only."""
