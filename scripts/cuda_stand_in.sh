#!/usr/bin/env bash
# Builds a stand-in for NVIDIA's driver and compiler that runs kernels on the processor, to test the path by CUDA where there is no card:
# crates/sphorge-gpu/tests/cuda_stand_in/README.md.
#
# usage: cuda_stand_in.sh FOLDER      needs: g++
set -euo pipefail
folder=${1:?name a folder for the libraries}
source=$(dirname "${BASH_SOURCE[0]}")/../crates/sphorge-gpu/tests/cuda_stand_in
mkdir -p "$folder"
build() {
    g++ -std=c++17 -O1 -Wall -Wextra -Werror -fvisibility=hidden -shared -fPIC -Wl,-soname,"$1" -o "$folder/$1" "$source/$2" -ldl
}
build libcuda.so.1 driver.cpp
build libnvrtc.so.13 nvrtc.cpp
# The names that are looked for first.
ln -sf libcuda.so.1 "$folder/libcuda.so"
ln -sf libnvrtc.so.13 "$folder/libnvrtc.so"
cp "$source/prelude.h" "$folder"
