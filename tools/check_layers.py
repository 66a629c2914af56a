#!/usr/bin/env python3
"""Proves the order of the layers, as layers.toml states it.

usage: tools/check_layers.py [--root FOLDER]

Reads every #include below src/ and apps/ and every CMakeLists.txt there, and names FILE:LINE of each
that reaches a layer further down the list, or foreign code that belongs to another layer.
Exit status: 0 the order holds, 1 it does not, 2 layers.toml or the command is wrong.
"""

import argparse
import pathlib
import re
import sys
import tomllib

SOURCES = {".h", ".hpp", ".inl", ".cpp", ".cc", ".cxx"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
LAYER_TARGET = re.compile(r"\bisochor(?:::|_)(\w+)")
DEPENDS = re.compile(r"\bDEPENDS\b([^)]*)")
KEYWORDS = {"SOURCES", "HEADERS", "DEPENDS", "LINK", "PRIVATE_LINK"}


class Rules:
    """What layers.toml says."""

    def __init__(self, path):
        with open(path, "rb") as file:
            data = tomllib.load(file)
        self.order = data["order"]
        self.rank = {layer: i for i, layer in enumerate(self.order)}
        self.exclusive = []
        for rule in data.get("exclusive", []):
            for layer in rule["layers"]:
                if layer not in self.rank:
                    raise ValueError(f"'{rule['name']}' names the unknown layer '{layer}'")
            self.exclusive.append(
                {
                    "name": rule["name"],
                    "layers": rule["layers"],
                    "headers": re.compile("|".join(f"(?:{p})" for p in rule["headers"])),
                    "targets": re.compile("|".join(f"(?:{p})" for p in rule["targets"])),
                }
            )

    def foreign(self, kind, name, layer):
        """The complaint about a foreign header or CMake target, or None."""
        for rule in self.exclusive:
            if layer not in rule["layers"] and rule[kind].fullmatch(name):
                return f"{name}: {rule['name']} is only for {', '.join(rule['layers'])}, not {layer}"
        return None

    def upward(self, used, layer):
        """The complaint about the use of a layer of ours, or None."""
        if used not in self.rank:
            return f"'{used}' is not a layer of layers.toml"
        if self.rank[used] > self.rank[layer]:
            return f"{layer} must not use {used}, which comes later in layers.toml"
        return None


def layer_of(path, root):
    """The layer that a file belongs to, or None outside of the layers."""
    parts = path.relative_to(root).parts
    if parts[0] == "apps":
        return "apps"
    if parts[:2] == ("src", "isochor") and len(parts) > 3:
        return parts[2]
    return None


def used_layer(quote, name, path, root):
    """The layer whose header an #include names, or None for foreign headers."""
    if name.startswith("isochor/"):
        return name.split("/")[1]
    if quote == '"':
        target = (path.parent / name).resolve()
        if target.is_file() and target.is_relative_to(root):
            return layer_of(target, root)
    return None


def check_source(path, layer, root, rules):
    text = path.read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        quote, name = match.groups()
        used = used_layer(quote, name, path, root)
        complaint = rules.upward(used, layer) if used else rules.foreign("headers", name, layer)
        if complaint:
            yield number, f"#include of {name}: {complaint}"


def check_cmake(path, layer, rules):
    text = re.sub(r"#[^\n]*", "", path.read_text(encoding="utf-8", errors="replace"))
    seen = []
    for match in DEPENDS.finditer(text):
        for word in re.finditer(r"[\w:]+", match.group(1)):
            if word.group() in KEYWORDS:
                break
            seen.append((match.start(1) + word.start(), word.group()))
    for match in LAYER_TARGET.finditer(text):
        if match.group(1) in rules.rank:
            seen.append((match.start(), match.group(1)))
    for position, used in seen:
        complaint = rules.upward(used, layer)
        if complaint:
            yield text.count("\n", 0, position) + 1, f"link to {used}: {complaint}"
    for match in re.finditer(r"[\w:.+-]+", text):
        complaint = rules.foreign("targets", match.group(), layer)
        if complaint:
            yield text.count("\n", 0, match.start()) + 1, f"link to {complaint}"


def check(root, rules):
    """All complaints as (path, line, text), and the number of files read."""
    complaints = []
    files = 0
    for top in ("src", "apps"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in SOURCES and path.name != "CMakeLists.txt":
                continue
            layer = layer_of(path, root)
            if layer is None:
                continue
            files += 1
            if layer not in rules.rank:
                complaints.append((path, 1, f"the folder '{layer}' is not a layer of layers.toml"))
            elif path.name == "CMakeLists.txt":
                complaints += [(path, n, t) for n, t in check_cmake(path, layer, rules)]
            else:
                complaints += [(path, n, t) for n, t in check_source(path, layer, root, rules)]
    return complaints, files


def main():
    parser = argparse.ArgumentParser(description="Proves the order of the layers in layers.toml.")
    default = pathlib.Path(__file__).resolve().parent.parent
    parser.add_argument("--root", type=pathlib.Path, default=default, help="the checkout")
    root = parser.parse_args().root.resolve()
    try:
        rules = Rules(root / "layers.toml")
    except (OSError, KeyError, ValueError, re.error) as error:
        print(f"check_layers: layers.toml: {error}", file=sys.stderr)
        return 2
    complaints, files = check(root, rules)
    for path, line, text in complaints:
        print(f"{path.relative_to(root)}:{line}: {text}", file=sys.stderr)
    if complaints:
        return 1
    print(f"layers: {files} files in order")
    return 0


if __name__ == "__main__":
    sys.exit(main())
