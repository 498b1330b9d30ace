"""Gears as solids with exact faces, made by the OpenCASCADE library, which only the extra ``step`` installs."""
