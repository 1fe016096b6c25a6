"""XML documents as lists that are equal if the documents mean the same; numbers are compared to 1e-12."""

import xml.etree.ElementTree as ElementTree

TOLERANCE = 1e-12


def read(text, comments=False):
    """[(path, kind, content)] in document order: attributes sorted, white space simplified, empty text left out."""
    builder = ElementTree.TreeBuilder(insert_comments=True)
    root = ElementTree.fromstring(text, parser=ElementTree.XMLParser(target=builder))
    found = []

    def words(content):
        return " ".join((content or "").split())

    def walk(element, path):
        if element.tag is ElementTree.Comment:
            if comments:
                found.append((path, "comment", words(element.text)))
            return
        path = f"{path}/{element.tag}"
        found.append((path, "attributes", sorted(element.attrib.items())))
        if words(element.text):
            found.append((path, "text", words(element.text)))
        for child in element:
            walk(child, path)
            if words(child.tail):
                found.append((path, "text", words(child.tail)))

    walk(root, "")
    return found


def same_words(left, right):
    left, right = left.split(), right.split()
    return len(left) == len(right) and all(map(same_word, left, right))


def same_word(left, right):
    if left == right:
        return True
    try:
        a, b = float(left), float(right)
    except ValueError:
        return False
    return abs(a - b) <= TOLERANCE * max(1.0, abs(a))


def same(left, right):
    if left[:2] != right[:2]:
        return False
    if left[1] != "attributes":
        return same_words(left[2], right[2])
    names = [name for name, _ in left[2]] == [name for name, _ in right[2]]
    return names and all(same_words(a, b) for (_, a), (_, b) in zip(left[2], right[2]))


def difference(left, right, comments=False):
    """The first difference between two documents, or None."""
    left, right = read(left, comments), read(right, comments)
    for a, b in zip(left, right):
        if not same(a, b):
            return f"{a} and {b}"
    return None if len(left) == len(right) else f"{len(left)} and {len(right)} parts"
