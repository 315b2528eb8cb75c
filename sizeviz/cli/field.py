"""``sizeviz field``: the processed size field, to drive this or any other mesher."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from sizeviz.cli.options import FieldOptions, FileArgument, MethodName, SourceArgument


def field(
    source: SourceArgument,
    /,
    *,
    output: FileArgument,
    method: Annotated[MethodName, Parameter(help="What is done to the field.")] = "size-preserving",
    options: FieldOptions | None = None,
) -> None:
    """Write the processed size field only."""
    from sizeviz.cli.options import loaded, study_options
    from sizeviz.cli.terminal import progress, warn_about_beta
    from sizeviz.files import require_writable_file, write_field
    from sizeviz.files.registry import FIELD_WRITERS, require_writable_suffix
    from sizeviz.study import Study, processed

    options = options or FieldOptions()
    require_writable_suffix(output, FIELD_WRITERS, "written as a size field")
    require_writable_file(output)
    asked = study_options(options)
    warn_about_beta(options.beta)
    with progress() as monitor:
        result = processed(Study(loaded(source, options), asked), method, monitor)
    write_field(output, result)
    sizes = result.sizes
    print(f"{output}: {method} field of {len(sizes):,} nodes, sizes {sizes.min():.4g} to {sizes.max():.4g}")
