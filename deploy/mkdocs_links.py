# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
"""Hooks of mkdocs.yml: README.md becomes the first page, and links that leave docs/ become the name of what they lead to.

With `repo_url` in mkdocs.yml they lead into the repository instead.
"""

import pathlib
import posixpath
import re
import tempfile

from mkdocs.structure.files import File

LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)\s]+)\)")
HOME = "index.md"
_home = tempfile.TemporaryDirectory()  # pylint: disable=consider-using-with


def on_files(files, config):
    """README.md as the first page; its links are from the folder above."""
    root = pathlib.Path(config["docs_dir"]).parent
    text = (root / "README.md").read_text(encoding="utf-8")
    text = re.sub(r"\]\(docs/", "](", text)
    (pathlib.Path(_home.name) / HOME).write_text(text, encoding="utf-8")
    files.append(File(HOME, _home.name, config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown, page, config, files):
    """Links to pages stay; those to files of the source are no pages of the site."""
    folder = posixpath.dirname(page.file.src_path)
    pages = {file.src_path for file in files}

    def there(link: re.Match[str]) -> str:
        text, target = link[1], link[2]
        if re.match(r"[a-z]+:|#", target):
            return link[0]
        path = posixpath.normpath(posixpath.join(folder, target.partition("#")[0]))
        if path in pages:
            return link[0]
        of_source = path[3:] if path.startswith("../") else (path if page.file.src_path == HOME else f"docs/{path}")
        if config["repo_url"]:
            return f"[{text}]({config['repo_url'].rstrip('/')}/tree/HEAD/{of_source})"
        return text if of_source.rpartition("/")[2] in text.replace("`", "") else f"{text} (`{of_source}`)"

    return LINK.sub(there, markdown)
