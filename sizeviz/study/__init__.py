"""The immutable study and the pipeline that runs it."""

from sizeviz.study.options import StudyOptions
from sizeviz.study.pipeline import COMPARED, GUARANTEED, METHODS, processed, run
from sizeviz.study.study import MethodRun, Study

__all__ = ["COMPARED", "GUARANTEED", "METHODS", "MethodRun", "Study", "StudyOptions", "processed", "run"]
