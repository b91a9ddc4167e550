"""What is said of the Python module elsewhere: in its type stubs, and in the messages beside it."""
import ast
import os
import re

from conftest import PROJECT

import collision_pairs as cp


def signatures_of_module():
    """{class.method: [(argument, default or None)]}, as the docstrings of the compiled module say."""
    found = {}
    for name in cp.__all__:
        for method in ("__init__", "check", "from_urdf", "from_parameters", "from_uri", "with_objects"):
            doc = getattr(getattr(cp, name).__dict__.get(method), "__doc__", None) or ""
            if method in cp.__dict__.get(name).__dict__ and "(" in doc and doc.startswith(method):
                arguments = re.match(r"\w+\((.*)\) ->", doc.splitlines()[0]).group(1)
                names = re.findall(r"(?:^|, )(\w+): [^=]*?(?: = ([^,]+))?(?=, \w+: |$)", arguments)
                found[name + "." + method] = [n for n in names if n[0] != "self"]
    return found


def test_the_stubs_name_what_the_module_has():
    with open(os.path.join(PROJECT, "src/python/collision_pairs/__init__.pyi")) as stubs:
        tree = ast.parse(stubs.read())
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    assert sorted(classes) == sorted(cp.__all__)
    module = signatures_of_module()
    assert len(module) > 12
    for name, node in classes.items():
        assert getattr(cp, name).__doc__ or name == "InputError", name
        members = {member.name: member for member in node.body if isinstance(member, ast.FunctionDef)}
        public = {n for n in vars(getattr(cp, name)) if not n.startswith("_") and n not in ("args", "with_traceback")}
        if not issubclass(getattr(cp, name), (int, Exception)):
            assert public == {n for n in members if not n.startswith("_")}, name
        for method, member in members.items():
            if name + "." + method not in module:
                continue
            stubbed = [argument.arg for argument in member.args.args if argument.arg != "self"]
            assert stubbed == [argument for argument, _ in module[name + "." + method]], (name, method)
            defaults = [ast.literal_eval(d) for d in member.args.defaults if not isinstance(d, ast.Constant)
                        or d.value is not Ellipsis]
            given = [ast.literal_eval(d) for _, d in module[name + "." + method] if d and not d.startswith("array(")]
            assert [d or None for d in defaults] == [d or None for d in given], (name, method)
    for enum in (cp.Verdict, cp.Fidelity, cp.PairState, cp.Certainty):
        stubbed = {entry.targets[0].id: entry.value.value for entry in classes[enum.__name__].body
                   if isinstance(entry, ast.Assign)}
        assert stubbed == {member.name: member.value for member in enum}


def test_the_enums_are_those_of_the_messages():
    from collision_pairs.msg import CollisionPair, CollisionPairs
    assert all(getattr(CollisionPairs, verdict.name) == verdict for verdict in cp.Verdict)
    assert all(getattr(CollisionPair, state.name) == state for state in cp.PairState)
    assert all(getattr(CollisionPair, worth.name) == worth for worth in cp.Certainty)
