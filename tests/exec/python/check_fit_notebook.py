"""Executes runtime/python/fit.ipynb: the model without friction is refused, air is called for, oil is not, and the truth is within three errors."""
import re, sys
import nbclient, nbformat

nb = nbformat.read(sys.argv[1], 4)
nbformat.validate(nb)
assert not any(c.get("outputs") for c in nb.cells), "the notebook is stored without results"
nbclient.NotebookClient(nb, timeout=300, kernel_name="python3", resources={"metadata": {"path": "runtime/python"}}).execute()


def printed(word):
    cell, = [c for c in nb.cells if c.cell_type == "code" and word in c.source]
    return "".join(o.text for o in cell.outputs if o.get("name") == "stdout")  # the kernel itself may warn behind it


bare = printed('"l,th", "--svg"')
assert "the model or the errors are wrong" in bare and "a trend is left" in bare, bare
verdict = dict(re.findall(r"^(oil|air) .*  (called for|not called for)$", printed("scene both"), re.M))
assert verdict == {"oil": "not called for", "air": "called for"}, verdict
found = printed("scene found")
for name, truth in ("l", 1.05), ("air.k", 0.08):
    value, error = map(float, re.search(rf"^  {name} +(\S+) \+- ([^ ,]+)", found, re.M).groups())
    assert abs(value - truth) < 3 * error < 0.03 * truth, (name, value, error)
assert "no trend is left" in found, found
