"""Draws mistakes at random from the C++ sources: see scripts/mutate --random.

Each is one line of one file, changed in one place by one of OPERATORS. Lines are drawn with equal probability among
those that any operator can change, so layers are met in proportion to their size; then the operator, then the place.
"""
import fnmatch
import glob
import os
import random
import re

WORD = r"[A-Za-z_][\w.]*(?:->\w+|\[\w+\]|\(\))*"
NUMBER = r"(?<![\w.])\d+(?:\.\d*)?(?:e-?\d+)?(?![\w.])"
# Of lines without comments and the text of strings. clang-format puts spaces around binary operators only, so that
# "<" of a template, a reference and a pointer differ from them.
SWAPS = {
    "relation": {" < ": " <= ", " <= ": " < ", " > ": " >= ", " >= ": " > ", " == ": " != ", " != ": " == "},
    "logic": {" && ": " || ", " || ": " && ", "true": "false", "false": "true"},
    "arithmetic": {" + ": " - ", " - ": " + ", " * ": " / ", " / ": " * ", " += ": " -= ", " -= ": " += ",
                   "std::max(": "std::min(", "std::min(": "std::max("},
}
NOT_CODE = re.compile(r"\s*(#|using |namespace |template|static_assert|class |struct |enum |friend |public|private|"
                      r"extern|typedef|case .*:$|default:|\}|\{$|$)")
DECLARATION = re.compile(r"\s*(return|throw|break|continue|goto|static|const|auto|[\w:]+(<.*>)?[&*]* [\w, ]+( =|;|\(|\{|\[))")


def masked(text):
    """The text with comments, and what is between quotes, blanked: same length, same lines."""
    pattern = re.compile(r'R"(\w*)\(.*?\)\1"|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def closing(code, begin):
    """Index of the parenthesis that closes the one at `begin`, or -1."""
    depth = 0
    for i in range(begin, len(code)):
        depth += {"(": 1, ")": -1}.get(code[i], 0)
        if depth == 0:
            return i
    return -1


def swaps(code, kind):
    for old, new in SWAPS[kind].items():
        for match in re.finditer((r"\b%s\b" if old.isalpha() else "%s") % re.escape(old), code):
            yield match.start(), match.end(), new


def constants(code):
    for match in re.finditer(NUMBER, code):
        number = match.group()
        if number.isdigit():
            changed = ["1"] if number == "0" else [str(int(number) + 1), str(int(number) - 1)]
        else:
            changed = ["1.0"] if float(number) == 0.0 else ["(2.0 * %s)" % number, "(0.5 * %s)" % number]
        for new in changed:
            yield match.start(), match.end(), new


def arguments(code):
    """Two neighbouring arguments exchanged."""
    for match in re.finditer(r"(?<=[(,{] )(%s), (%s)(?=[,)}])|(?<=[({])(%s), (%s)(?=[,)}])" % ((WORD,) * 4), code):
        first, second = [group for group in match.groups() if group is not None]
        if first != second:
            yield match.start(), match.end(), "%s, %s" % (second, first)


def negations(code):
    for match in re.finditer(r"!(?=[\w(])", code):
        yield match.start(), match.end(), ""


def conditions(code):
    """A condition that always, or never, holds."""
    for match in re.finditer(r"\b(if|while) \(", code):
        end = closing(code, match.end() - 1)
        if end >= 0:
            for value in ["true", "false"] if match.group(1) == "if" else ["false"]:
                yield match.end(), end, value
    for match in re.finditer(r"return ([^;]*) \? ([^:;]*) : ([^;]*);", code):
        yield match.start(1), match.end(3), match.group(2)
        yield match.start(1), match.end(3), match.group(3)


def statements(code):
    """A call or an assignment that is missing."""
    stripped = code.strip()
    if (stripped.endswith(";") and re.match(r"[\w(*+-]", stripped) and not DECLARATION.match(code)
            and code.count("(") == code.count(")") and not re.match(r"(if|for|while|else|do)\b", stripped)):
        yield code.index(stripped), code.rindex(";"), ""
    for match in re.finditer(r"^\s*(?:if|for) \(", code):
        end = closing(code, match.end() - 1)
        rest = code[end + 1:]
        if end >= 0 and rest.rstrip().endswith(";") and rest.count("(") == rest.count(")"):
            yield end + 1, code.rindex(";"), ""


OPERATORS = {"relation": lambda code: swaps(code, "relation"), "logic": lambda code: swaps(code, "logic"),
             "arithmetic": lambda code: swaps(code, "arithmetic"), "constant": constants, "argument": arguments,
             "negation": negations, "condition": conditions, "statement": statements}


def changes(code):
    """Of a masked line: by operator, the places (begin, end) and what comes there."""
    if NOT_CODE.match(code) or code.rstrip().endswith("\\"):
        return {}
    found = {name: list(operator(code)) for name, operator in OPERATORS.items()}
    return {name: places for name, places in found.items() if places}


def draw(root, seed, files=("*",)):
    """Yields (file, row from 0, line, changed line, operator), without end repeated but for lines drawn before."""
    paths = sorted(path for ending in ("cpp", "h") for top in ("src", "include")
                   for path in glob.glob(os.path.join(root, top, "**", "*." + ending), recursive=True)
                   if any(fnmatch.fnmatch(os.path.relpath(path, root), pattern) for pattern in files))
    lines = []
    for path in paths:
        with open(path, encoding="utf-8") as file:
            text = file.read()
        # A statement may be dropped only where one begins: after the end of another.
        before = ";"
        codes = masked(text).split("\n")
        for row, (line, code) in enumerate(zip(text.split("\n"), codes)):
            # Not who gets a signal, nor what is decided just before it: kill(-1, ...) would end everything.
            found = {} if "::kill(" in "".join(codes[row:row + 2]) else changes(code)
            if before[-1] not in ";{}:":
                found.pop("statement", None)
            before = code.rstrip() or before
            if found:
                lines.append((os.path.relpath(path, root), row, line, found))
    chosen = random.Random(seed)
    chosen.shuffle(lines)
    for file, row, line, found in lines:
        operator = chosen.choice(sorted(found))
        begin, end, new = chosen.choice(found[operator])
        yield file, row, line, line[:begin] + new + line[end:], operator
