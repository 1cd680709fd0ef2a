"""The site: `make docs` builds it in build/site. docs/notes/docs.md says why it is made this way."""

import os
import pathlib
import re
import sys

root = pathlib.Path(__file__).parents[1]
build = pathlib.Path(os.environ.get("SELVAGE_BUILD", root / "build" / "release"))
sys.path[:0] = [str(root / "docs" / "extensions"), str(build / "python")]

project = "selvage"
version = release = re.search(r"VERSION (\S+)", (root / "CMakeLists.txt").read_text().split("project(")[1])[1]
author = "the selvage developers"
copyright = author

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "selvage_reference"]
exclude_patterns = ["images/README.md", "selvage.tag"]
# Anchors of headings as GitHub makes them, so that links work there and here.
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]

default_role = "code"  # of a single backtick in docstrings
autodoc_typehints = "none"  # docstrings say it
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "undoc-members": True}
napoleon_google_docstring = False
napoleon_use_ivar = True

# `make docs-links`: publishers that turn programs away are asked by the resolver of DOIs alone.
linkcheck_timeout = 20
linkcheck_retries = 2
linkcheck_workers = 4
linkcheck_anchors = False
linkcheck_allowed_redirects = {r"https://doi\.org/.*": r".*"}
linkcheck_ignore = [r"\.\./cpp/.*"]  # pages of Doxygen, beside those of Sphinx

html_theme = "furo"
html_title = "selvage"
html_copy_source = False
html_show_sphinx = False
html_extra_path = ["api"]  # the pages of Doxygen, in cpp/

selvage_program = str(build / "selvage")
selvage_tags = str(root / "docs" / "api" / "selvage.tag")
selvage_scene_reader = str(root / "src" / "scene" / "description")
selvage_scene_guide = str(root / "docs" / "guides" / "scene_files.md")
