"""The figures of the paper and of an adaptive process, drawn with matplotlib."""
