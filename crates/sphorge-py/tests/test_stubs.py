"""The hand-written types of the extension module are those of what is in it."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

from sphorge import _sphorge

STUB = Path(_sphorge.__file__).parent / "_sphorge.pyi"


def parameters(function: ast.FunctionDef) -> list[tuple[str, bool, bool]]:
    """Names of the parameters, whether each is a keyword alone, and whether it has a default."""
    arguments = function.args
    plain = [*arguments.posonlyargs, *arguments.args]
    defaults = len(plain) - len(arguments.defaults)
    told = [(of.arg, False, k >= defaults) for k, of in enumerate(plain)]
    told += [(of.arg, True, default is not None) for of, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    return [one for one in told if one[0] not in ("self", "cls")]


def of_module(value: object) -> list[tuple[str, bool, bool]]:
    signature = inspect.signature(value)  # type: ignore[arg-type]
    told = [(of.name, of.kind is of.KEYWORD_ONLY, of.default is not of.empty) for of in signature.parameters.values()]
    return [one for one in told if one[0] not in ("self", "cls")]


def test_every_name_has_its_types_and_no_other():
    tree = ast.parse(STUB.read_text(encoding="utf-8"))
    stub: dict[str, ast.AST] = {}
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            stub[node.name] = node
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            stub[node.target.id] = node
    there = {name for name in dir(_sphorge) if not name.startswith("__") or name == "__version__"}
    assert set(stub) == there
    for name, node in stub.items():
        value = getattr(_sphorge, name)
        if isinstance(node, ast.FunctionDef):
            assert parameters(node) == of_module(value), name
        elif isinstance(node, ast.ClassDef):
            members = {part.name: part for part in node.body if isinstance(part, ast.FunctionDef)}
            own = {part for part in vars(value) if not part.startswith("__")}
            assert {part for part in members if not part.startswith("__")} == own, name
            for part, types in members.items():
                is_property = any(isinstance(of, ast.Name) and of.id == "property" for of in types.decorator_list)
                assert is_property == inspect.isgetsetdescriptor(vars(value).get(part)), f"{name}.{part}"
                if not is_property:
                    of = value if part == "__new__" else getattr(value, part)
                    assert parameters(types) == of_module(of), f"{name}.{part}"
