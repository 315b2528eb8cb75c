import numpy as np
import pytest
from shapely.geometry import Polygon

from sizeviz.errors import InputError
from sizeviz.geometry.domain import signed_area
from sizeviz.sources.shapes import SHAPES, shape


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_is_a_valid_domain_in_the_unit_square(name: str) -> None:
    domain = shape(name)
    polygon = Polygon(domain.outer, domain.holes)
    assert polygon.is_valid
    assert domain.area == pytest.approx(polygon.area, rel=1e-12)
    assert min(domain.bounds) >= 0.0 and max(domain.bounds) <= 1.0
    assert signed_area(domain.outer) > 0
    assert all(signed_area(hole) < 0 for hole in domain.holes)


def test_the_disk_has_one_closed_curve_and_the_square_four_sides() -> None:
    assert [curve.closed for curve in shape("disk").curves] == [True]
    sides = shape("square").curves
    assert [curve.length for curve in sides] == [1.0] * 4
    assert np.array_equal(sides[0].points[-1], sides[1].points[0])


def test_an_unknown_shape_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="no shape 'dodecahedron'; choose one of square"):
        shape("dodecahedron")
