"""Backend of `pip install runtime/python` (PEP 517): a wheel of what `make install` installs, beside lagc.py as the package `lagc`.

Enters: the source tree around this file; make, a C compiler, flex and bison. Leaves: lagc-VERSION-py3-none-PLATFORM.whl. Holds: no network, no other
package; the wheel needs NumPy and no C compiler. $BUILD is make's folder, default build.
"""
import base64
import hashlib
import os
import re
import subprocess
import sysconfig
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.normpath(os.path.join(HERE, "../.."))
KEPT = ("bin/", "lib/", "include/", "share/lagc/models/")  # of PREFIX
LEFT = ("lib/pkgconfig/", "lib/cmake/")  # their paths are those of the build

METADATA = """Metadata-Version: 2.1
Name: lagc
Version: {version}
Summary: Lagrangians as text: equations of motion, proofs, simulation
License: MIT (a binary that links GSL, as lag-run does where it is found: GPL-3)
Requires-Python: >=3.8
Requires-Dist: numpy
Description-Content-Type: text/markdown

{readme}"""
WHEEL = "Wheel-Version: 1.0\nGenerator: pack_wheel\nRoot-Is-Purelib: false\nTag: {tag}\n"
SCRIPTS = "[console_scripts]\nlagc = lagc:_main\n"


def _text(*path):
    with open(os.path.join(*path), encoding="utf-8") as f:
        return f.read()


def _installed(prefix):
    """Files of the installation by their names in the wheel; symbolic links are left out."""
    make = [os.environ.get("MAKE", "make"), "-C", ROOT, f"BUILD={os.environ.get('BUILD', 'build')}", f"PREFIX={prefix}", "PRECISIONS=", "install"]
    subprocess.run(make, check=True, stdout=subprocess.DEVNULL)
    for folder, _, names in os.walk(prefix):
        for name in names:
            path = os.path.join(folder, name)
            inside = os.path.relpath(path, prefix).replace(os.sep, "/")
            if inside.startswith(KEPT) and not inside.startswith(LEFT) and not os.path.islink(path):
                yield f"lagc/files/{inside}", path


def _add(wheel, record, name, data, mode=0o644):
    """Adds a file with a fixed date and its digest."""
    info = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
    info.external_attr = (0o100000 | mode) << 16
    info.compress_type = zipfile.ZIP_DEFLATED
    wheel.writestr(info, data)
    digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
    record.append(f"{name},sha256={digest},{len(data)}\n")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    version = re.search(r'LAG_VERSION "(.*)"', _text(ROOT, "runtime/include/lag.h")).group(1)
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    name, info, record = f"lagc-{version}-{tag}.whl", f"lagc-{version}.dist-info", []
    with tempfile.TemporaryDirectory() as prefix, zipfile.ZipFile(os.path.join(wheel_directory, name), "w") as wheel:
        _add(wheel, record, "lagc/__init__.py", _text(HERE, "lagc.py").encode())
        for inside, path in sorted(_installed(prefix)):
            with open(path, "rb") as f:
                _add(wheel, record, inside, f.read(), os.stat(path).st_mode & 0o777)
        texts = {"METADATA": METADATA.format(version=version, readme=_text(HERE, "README.md")), "WHEEL": WHEEL.format(tag=tag),
                 "entry_points.txt": SCRIPTS, "licenses/LICENSE": _text(ROOT, "LICENSE")}
        for file, text in texts.items():
            _add(wheel, record, f"{info}/{file}", text.encode())
        _add(wheel, [], f"{info}/RECORD", "".join([*record, f"{info}/RECORD,,\n"]).encode())
    return name
