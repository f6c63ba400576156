"""Looks whether every link and picture of the book that `mdbook` made leads to something.

    mdbook build docs
    python3 scripts/check_book.py target/book

Asks that the file of every link inside the book is there, with the anchor if the link names one, and so is every picture. Lists what is
broken, with its page, and ends with 1; else prints how much was looked at. Links to other places are not followed. Wants only Python.
"""

import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    """What a page links to, what it draws, and the anchors it has."""

    def __init__(self, text):
        super().__init__()
        self.links = []
        self.pictures = []
        self.anchors = {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        if "id" in found:
            self.anchors.add(found["id"])
        if tag == "a":
            if "href" in found:
                self.links.append(found["href"])
            if "name" in found:
                self.anchors.add(found["name"])
        if tag == "img" and "src" in found:
            self.pictures.append(found["src"])


def fault(pages, book, path, address):
    """What is wrong with an address on the page at that path; None if nothing is or it leads out of the book."""
    parts = urllib.parse.urlsplit(address)
    if parts.scheme or parts.netloc:
        return None
    target = path
    if parts.path:
        target = (path.parent / urllib.parse.unquote(parts.path)).resolve()
        if target.is_dir():
            target = target / "index.html"
    if not target.is_relative_to(book):
        return "leads out of the book"
    if not target.is_file():
        return "no such file"
    if target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
        return f"no such anchor in {target.relative_to(book)}"
    return None


def main():
    if len(sys.argv) != 2:
        raise SystemExit("which book? python3 scripts/check_book.py target/book")
    book = pathlib.Path(sys.argv[1]).resolve()
    # The page for addresses that are not found is shown at any of them, so its links start at the root of a server.
    paths = [path for path in sorted(book.rglob("*.html")) if path.name != "404.html"]
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in paths}
    if not pages:
        raise SystemExit(f"there are no pages in {sys.argv[1]}")
    broken = []
    for path, page in pages.items():
        for kind, addresses in (("link", page.links), ("picture", page.pictures)):
            for address in dict.fromkeys(addresses):
                wrong = fault(pages, book, path, address)
                if wrong:
                    broken.append(f"{path.relative_to(book)}: {kind} {address}: {wrong}")
    if broken:
        raise SystemExit("\n".join(broken + [f"{len(broken)} broken"]))
    links = sum(len(page.links) for page in pages.values())
    pictures = sum(len(page.pictures) for page in pages.values())
    print(f"{len(pages)} pages, {links} links and {pictures} pictures, none broken")


if __name__ == "__main__":
    main()
