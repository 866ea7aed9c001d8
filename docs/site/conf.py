"""Sphinx's configuration. docs/site/build makes the source folder and calls Sphinx with it: see there."""
import os

work = os.environ["ROBOMILL_SITE_WORK"]  # what docs/site/build prepared: source/, static/, doxygen/xml

project = "robomill"
release = os.environ["ROBOMILL_SITE_VERSION"]
version = release
html_title = f"robomill {release}"
html_last_updated_fmt = None
copyright = "the authors of robomill; Apache-2.0"

extensions = ["myst_parser", "sphinx.ext.mathjax", "breathe"]
source_suffix = {".md": "markdown"}
root_doc = "index"
highlight_language = "none"  # indented blocks are commands, formulas and output
smartquotes = False  # -- is an option's beginning
nitpicky = True
# Types of the standard library, of Eigen and of private headers have no page, and Doxygen's names are not resolved as C++ does.
nitpick_ignore_regex = [("cpp:.*", ".*")]

myst_enable_extensions = ["dollarmath", "deflist"]
myst_heading_anchors = 6
myst_ref_domains = ["std"]
suppress_warnings = ["myst.header"]  # the READMEs of stages have #### below ## on GitHub

breathe_projects = {"robomill": os.path.join(work, "doxygen", "xml")}
breathe_default_project = "robomill"
breathe_default_members = ("members",)
cpp_id_attributes = ["ROBOMILL_API"]
cpp_debug_lookup = False

add_module_names = False

html_theme = "furo"
html_static_path = [os.path.join(work, "static")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_search_summary = False  # it would be fetched, which a page from a file may not
html_theme_options = {"navigation_with_keys": False}

# Debian's MathJax, beside the pages: nothing is loaded from elsewhere. Its SVG output needs no fonts.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG"
myst_update_mathjax = False  # which would configure MathJax 3
mathjax2_config = {
    "tex2jax": {"inlineMath": [["\\(", "\\)"]], "displayMath": [["\\[", "\\]"]], "processClass": "math", "processRefs": False},
    "messageStyle": "none",
    "showMathMenu": False,
    "SVG": {"scale": 95},
    "TeX": {"extensions": ["AMSmath.js", "AMSsymbols.js"]},
}


def hide_empty_contents(app, page, template, context, doctree):
    """A page without headings has no contents to list beside it; furo's script fails on an empty list."""
    if 'href="#' not in (context.get("toc") or "").replace('href="#"', ""):
        context["meta"] = {**(context.get("meta") or {}), "hide-toc": True}


def setup(app):
    app.connect("html-page-context", hide_empty_contents, priority=400)  # before furo
