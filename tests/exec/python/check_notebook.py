"""Executes runtime/python/double_pendulum.ipynb, and holds what its cells show against closed forms and what they must be."""
import ast, sys
import nbclient, nbformat

nb = nbformat.read(sys.argv[1], 4)
nbformat.validate(nb)
assert not any(c.get("outputs") for c in nb.cells), "the notebook is stored without results"
nbclient.NotebookClient(nb, timeout=300, kernel_name="python3", resources={"metadata": {"path": "runtime/python"}}).execute()


def shown(word, kind):
    """What the cell with this word shows."""
    cell, = [c for c in nb.cells if c.cell_type == "code" and word in c.source]
    if kind != "print":
        return cell.outputs[-1].data[kind]
    return "".join(o.text for o in cell.outputs if o.get("name") == "stdout")  # the kernel itself may warn behind it


latex = shown("lagc.load(\"../../models/double", "text/latex")
assert latex.startswith("$$\\begin{aligned}") and "\\ddot" in latex, latex
assert "th1''" in shown("print(m.equations)", "print")
assert shown("until=20", "image/svg+xml").startswith("<svg")
drift = float(shown("energy_drift", "text/plain").rstrip(")").split()[-1])
assert abs(drift) < 1e-8, drift
text = shown("m.rhs", "text/plain")
rates = ast.literal_eval(text[text.index("["):text.rindex("]") + 1])
# Two masses of 1 kg, l = 1 m, both angles 1, at rest, g = 1.62: th1'' = -g sin 1, th2'' = 0
assert rates[:2] == [0, 0] and abs(rates[2] + 1.62 * 0.8414709848078965) < 1e-7 and abs(rates[3]) < 1e-7, rates
text = shown("m.batch", "text/plain")
spread = ast.literal_eval(text[text.index("["):text.rindex("]") + 1])
assert 0 < spread[0] < spread[1], spread
text = shown("def mean", "text/plain")
assert max(map(abs, ast.literal_eval(text[text.index("["):text.rindex("]") + 1]))) < 1e-9, text
assert "did you mean" in shown("th3", "print"), shown("th3", "print")
