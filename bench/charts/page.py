"""The report as one HTML page that needs no other file: sections of text, charts and tables, light and dark."""

import base64
import html

STYLE = """
:root { --ink: #1b1b1b; --paper: #ffffff; --grid: #dddddd; --quiet: #595959; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e8e8; --paper: #16181c; --grid: #3a3d44; --quiet: #a8a8a8; }
}
body { background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, sans-serif; margin: 2rem auto;
       max-width: 1200px; padding: 0 1rem; }
h1 { line-height: 1.2; }
figure { margin: 1rem 0; }
figure svg { width: 100%; height: auto; fill: var(--ink); }
figure img { max-width: 100%; }
figcaption, .quiet { color: var(--quiet); font-size: 0.875rem; }
table { border-collapse: collapse; font-size: 0.875rem; font-variant-numeric: tabular-nums; }
th, td { border-bottom: 1px solid var(--grid); padding: 0.25rem 0.75rem; text-align: right; }
th:first-child, td:first-child, td.text, th.text { text-align: left; }
.wide { overflow-x: auto; }
pre { background: color-mix(in srgb, var(--grid) 40%, transparent); font-size: 0.8rem; overflow-x: auto;
      padding: 0.75rem; }
"""


def text(words):
    return f"<p>{html.escape(words)}</p>\n"


def chart(svg, caption=""):
    under = f"<figcaption>{html.escape(caption)}</figcaption>" if caption else ""
    return f"<figure>{svg}{under}</figure>\n"


def picture(path, caption):
    data = base64.b64encode(path.read_bytes()).decode()
    words = html.escape(caption)
    return (f'<figure><img src="data:image/png;base64,{data}" alt="{words}"><figcaption>{words}</figcaption>'
            "</figure>\n")


def table(heads, rows):
    def cells(tag, values):
        return "".join(f"<{tag}>{html.escape(str(value))}</{tag}>" for value in values)

    body = "".join(f"<tr>{cells('td', row)}</tr>\n" for row in rows)
    return f'<div class="wide"><table>\n<tr>{cells("th", heads)}</tr>\n{body}</table></div>\n'


def folded(title, content):
    return f"<details><summary>{html.escape(title)}</summary>\n{content}</details>\n"


def preformatted(words):
    return f"<pre>{html.escape(words)}</pre>\n"


def page(title, sections):
    """The whole page. sections: [(heading, its HTML)]."""
    body = "".join(f"<h2>{html.escape(heading)}</h2>\n{content}" for heading, content in sections)
    return (f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{html.escape(title)}</title>\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<meta name="color-scheme" content="light dark">\n<style>{STYLE}</style>\n</head>\n<body>\n'
            f"<h1>{html.escape(title)}</h1>\n{body}</body>\n</html>\n")
