#!/usr/bin/env python3
"""Who may include whom (ARCHITECTURE.md, "Rooms"). Fails on a forbidden include, on headers that include each other in a
circle, and on sources in a folder that is no room. `check_layers.py [ROOT]`."""

import re
import sys
from pathlib import Path

# Each room and the rooms whose headers it may include besides its own and the public ones.
GROUND = {"base", "math"}
WORLD = GROUND | {"mesh", "scene"}
ROOMS = {
    "base": set(),
    "math": {"base"},
    "mesh": GROUND,
    "scene": GROUND | {"mesh"},
    "cluster": GROUND | {"mesh"},
    "visibility": GROUND | {"mesh", "cluster"},
    "element": WORLD | {"cluster"},
    "solve": WORLD | {"cluster", "visibility", "element"},
    "reconstruct": WORLD | {"cluster", "visibility", "element", "solve"},
    "represent": WORLD | {"cluster", "visibility"},
    "trace": WORLD | {"cluster", "visibility"},
    "files": WORLD,
    "session": None,  # all rooms
}
PUBLIC = "include/goldthread"
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
# Comments may quote an include; strings hardly do.
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def sources(root):
    for folder in ("include", "src", "apps"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp") and path.is_file():
                yield path.relative_to(root)


def room_of(path):
    """"public", "apps", a folder of src, or None for what is nowhere."""
    parts = path.parts
    if path.as_posix().startswith(PUBLIC + "/"):
        return "public"
    if parts[0] == "apps":
        return "apps"
    if parts[0] == "src" and len(parts) > 2:
        return parts[1]
    return None


def resolve(root, path, name):
    """The file of ours that `#include "name"` in `path` means, or None."""
    for candidate in (path.parent / name, Path("src") / name, Path("include") / name):
        if (root / candidate).is_file():
            return Path(*(root / candidate).resolve().relative_to(root).parts)
    return None


def may_include(room, target):
    if room == target:
        return True
    if room in ("public", "apps"):
        return target == "public"
    if target == "public":
        return room not in ("base", "math", "mesh")
    allowed = ROOMS[room]
    return target in ROOMS if allowed is None else target in allowed


def find_cycle(graph):
    """One circle of headers as a list, or None."""
    done = set()
    for start in graph:
        trail, stack = [], [(start, iter(graph[start]))]
        if start in done:
            continue
        trail.append(start)
        while stack:
            node, following = stack[-1]
            step = next((n for n in following if n not in done), None)
            if step is None:
                done.add(node)
                trail.pop()
                stack.pop()
            elif step in trail:
                return trail[trail.index(step):] + [step]
            else:
                trail.append(step)
                stack.append((step, iter(graph.get(step, ()))))
    return None


def check(root):
    root = root.resolve()
    problems, graph = [], {}
    for path in sources(root):
        room = room_of(path)
        if room not in ("public", "apps") and room not in ROOMS:
            problems.append(f"{path}: is in no room; add the folder to tools/check_layers.py and ARCHITECTURE.md")
            continue
        text = COMMENT.sub("", (root / path).read_text(encoding="utf-8", errors="replace"))
        graph[path] = []
        for name in INCLUDE.findall(text):
            target = resolve(root, path, name)
            if target is None:
                problems.append(f'{path}: "{name}" is no header of ours; write <{name}> or mend the path')
                continue
            graph[path].append(target)
            target_room = room_of(target)
            if not may_include(room, target_room):
                problems.append(f"{path}: {room} may not include {target_room} ({name})")
    cycle = find_cycle(graph)
    if cycle:
        problems.append("headers include each other in a circle: " + " -> ".join(map(str, cycle)))
    return problems


def main():
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent
    problems = check(root)
    for problem in problems:
        print(f"check_layers: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
