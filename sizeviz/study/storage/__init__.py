"""Study files, ``.sizeviz``: read and written whole or not at all, checked by a schema, saved by themselves."""

from sizeviz.study.storage.study_file import SUFFIX, StudyFile, read_study, write_study

__all__ = ["SUFFIX", "StudyFile", "read_study", "write_study"]
