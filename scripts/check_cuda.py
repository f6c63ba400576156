#!/usr/bin/env python3
"""Compiles kernels in CUDA C++ without a card: registers, spills and the threads that fit a multiprocessor.

usage: check_cuda.py FOLDER [ARCHITECTURE]      needs: pip install nvidia-cuda-nvrtc nvidia-cuda-nvcc (13.0)

FOLDER has *.cu, in folders of decks. Fails if one does not compile, or spills registers that it may not.
"""

import ctypes
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Of a multiprocessor of compute capability 9.0: registers, and threads at most.
REGISTERS, THREADS, BLOCK = 65536, 2048, 64
# Bytes that may be spilled, stores and loads together. The contact at facets clips quadrilaterals of two bodies against each other: their corners do not fit
# the 255 registers that a thread can have. Of all kernels of a step it alone runs over the particles of surfaces only.
MAY_SPILL = {"press_facets": 1280, "press_facets_renewed": 1280}
OPTIONS = [b"--fmad=false", b"--prec-div=false", b"--prec-sqrt=false"]


def wheel(pattern):
    found = [path for folder in sys.path for path in Path(folder).glob(pattern)] if sys.path else []
    if not found:
        sys.exit(f"{pattern} is not there: pip install 'nvidia-cuda-nvrtc==13.0.*' 'nvidia-cuda-nvcc==13.0.*'")
    return found[0]


def ptx(nvrtc, path, architecture):
    program = ctypes.c_void_p()
    nvrtc.nvrtcCreateProgram(ctypes.byref(program), path.read_bytes(), path.name.encode(), 0, None, None)
    # Those of crates/sphorge-gpu/src/device/cuda/compile.rs.
    options = [f"--gpu-architecture=compute_{architecture}".encode(), *OPTIONS]
    failed = nvrtc.nvrtcCompileProgram(program, len(options), (ctypes.c_char_p * len(options))(*options))
    size = ctypes.c_size_t()
    if failed:
        nvrtc.nvrtcGetProgramLogSize(program, ctypes.byref(size))
        log = ctypes.create_string_buffer(size.value)
        nvrtc.nvrtcGetProgramLog(program, log)
        sys.exit(f"{path} does not compile:\n{log.value.decode()}")
    nvrtc.nvrtcGetPTXSize(program, ctypes.byref(size))
    text = ctypes.create_string_buffer(size.value)
    nvrtc.nvrtcGetPTX(program, text)
    return text.value


def main():
    folder, architecture = Path(sys.argv[1]), sys.argv[2] if len(sys.argv) > 2 else "90"
    # The compiler looks for these by name: they are there once they are loaded.
    ctypes.CDLL(str(wheel("nvidia/**/libnvrtc-builtins.so.*")), mode=ctypes.RTLD_GLOBAL)
    nvrtc = ctypes.CDLL(str(wheel("nvidia/**/libnvrtc.so.*")))
    ptxas = wheel("nvidia/**/bin/ptxas")
    kernels = sorted(folder.glob("*/*.cu"))
    if not kernels:
        sys.exit(f"no kernels in {folder}")
    spilled = []
    print(f"{'deck':<22}{'kernel':<32}{'registers':>10}{'spilled':>9}{'occupancy':>11}")
    for path in kernels:
        with tempfile.NamedTemporaryFile(suffix=".ptx") as file:
            file.write(ptx(nvrtc, path, architecture))
            file.flush()
            command = [ptxas, f"-arch=sm_{architecture}", "-v", file.name, "-o", "/dev/null"]
            told = subprocess.run(command, capture_output=True, text=True, check=True).stderr
        registers = int(re.search(r"Used (\d+) registers", told)[1])
        spills = sum(map(int, re.findall(r"(\d+) bytes spill", told)))
        fit = min(THREADS, REGISTERS // (-(-registers // 8) * 8 * BLOCK) * BLOCK)
        print(f"{path.parent.name:<22}{path.stem:<32}{registers:>10}{spills:>9}{fit / THREADS:>11.0%}")
        if spills > MAY_SPILL.get(path.stem, 0):
            spilled.append(path)
    if spilled:
        sys.exit("registers are spilled: " + ", ".join(map(str, spilled)))


main()
