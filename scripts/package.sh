#!/usr/bin/env bash
# Makes what can be installed without Rust, and checks it: a program for older Linux systems with its checksum, a Debian package of it, and the crates.
#
#     scripts/package.sh [--profile PROFILE] [program] [deb] [crates]
#
# All three unless some are named. They come to target/packages. The program is linked by Zig for glibc 2.17, so that it runs on any Linux of the last ten years; PROFILE is
# `release` unless another is given. Needs Rust, Python 3 and, for the package, dpkg-deb; fetches Zig and cargo-zigbuild from PyPI. Nothing is published.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=$PWD/target/packages profile=release wanted=()
while [ $# -gt 0 ]; do
    case $1 in
        --profile) profile=$2 && shift ;;
        program | deb | crates) wanted+=("$1") ;;
        *) sed -n '2,8s/^# \{0,1\}//p' "$0" && exit 2 ;;
    esac
    shift
done
[ ${#wanted[@]} -gt 0 ] || wanted=(program deb crates)
wants() { [[ " ${wanted[*]} " == *" $1 "* ]]; }

version=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
machine=$(uname -m)
glibc=2.17
name=sphorge-$version-$machine-linux
mkdir -p "$out"

# What belongs beside the program, in the layout of /usr.
layout() {
    local program=$1 usr=$2 command
    mkdir -p "$usr/bin" "$usr/share/man/man1" "$usr/share/bash-completion/completions" "$usr/share/zsh/vendor-completions" "$usr/share/fish/vendor_completions.d" \
        "$usr/share/doc/sphorge"
    install -m 755 "$program" "$usr/bin/sphorge"
    "$program" man >"$usr/share/man/man1/sphorge.1"
    for command in run resume check decks materials plot sweep convergence ballistic-limit compare validate; do
        "$program" man "$command" >"$usr/share/man/man1/sphorge-$command.1"
    done
    gzip -9nf "$usr"/share/man/man1/*.1
    "$program" completions bash >"$usr/share/bash-completion/completions/sphorge"
    "$program" completions zsh >"$usr/share/zsh/vendor-completions/_sphorge"
    "$program" completions fish >"$usr/share/fish/vendor_completions.d/sphorge.fish"
    "$program" schema >"$usr/share/doc/sphorge/deck.schema.json"
    install -m 644 README.md CHANGELOG.md AGENTS.md LICENSE-MIT LICENSE-APACHE "$usr/share/doc/sphorge/"
}

program() {
    local tools=$PWD/target/wheel/zig target=$machine-unknown-linux-gnu folder=$profile
    [ -x "$tools/bin/python" ] || python3 -m venv "$tools"
    "$tools/bin/python" -m pip install --quiet --disable-pip-version-check ziglang cargo-zigbuild
    PATH="$tools/bin:$PATH" cargo zigbuild -p sphorge-cli --profile "$profile" --target "$target.$glibc" --locked --quiet
    local built=target/$target/$folder/sphorge
    # The newest symbol of glibc that it asks for.
    local newest
    newest=$(grep -aoE 'GLIBC_[0-9]+\.[0-9]+' "$built" | sort -uV | tail -n 1)
    if [ "$(printf '%s\n' "GLIBC_$glibc" "$newest" | sort -V | tail -n 1)" != "GLIBC_$glibc" ]; then
        echo "the program needs $newest, more than glibc $glibc" >&2
        return 1
    fi
    rm -rf "$out/$name" && layout "$built" "$out/$name"
    # The same files give the same archive.
    tar -C "$out" --sort=name --owner=0 --group=0 --numeric-owner --mtime=@0 -cf - "$name" | gzip -9n >"$out/$name.tar.gz"
    (cd "$out" && sha256sum "$name.tar.gz" >"$name.tar.gz.sha256" && sha256sum --check --quiet "$name.tar.gz.sha256")
    "$out/$name/bin/sphorge" --version
    echo "$name.tar.gz: $(stat -c %s "$out/$name.tar.gz") bytes, program $(stat -c %s "$out/$name/bin/sphorge") bytes, needs $newest"
}

deb() {
    if ! command -v dpkg-deb >/dev/null; then
        echo "skipped: no dpkg-deb here"
        return 0
    fi
    [ -x "$out/$name/bin/sphorge" ] || program
    local architecture tree=$out/deb package
    architecture=$(dpkg --print-architecture)
    package=$out/sphorge_${version}_$architecture.deb
    rm -rf "$tree" && mkdir -p "$tree/DEBIAN" && cp -r "$out/$name" "$tree/usr"
    { printf 'Sphorge is licensed under MIT OR Apache-2.0.\n\n' && cat LICENSE-MIT; } >"$tree/usr/share/doc/sphorge/copyright"
    chmod -R u+rwX,go+rX,go-w "$tree"
    cat >"$tree/DEBIAN/control" <<CONTROL
Package: sphorge
Version: $version
Architecture: $architecture
Maintainer: The Sphorge developers <sphorge@localhost>
Depends: libc6 (>= $glibc)
Installed-Size: $(du -sk "$tree/usr" | cut -f 1)
Section: science
Priority: optional
Description: Smoothed-particle hydrodynamics for metals that yield, flow and break
 Impact, large plastic deformation, shock waves and heat: a solver with its command line, decks and pictures.
CONTROL
    dpkg-deb --root-owner-group --build "$tree" "$package" >/dev/null
    # What it holds, and that it unpacks to a program that runs.
    local listed
    listed=$(dpkg -c "$package")
    for file in ./usr/bin/sphorge ./usr/share/man/man1/sphorge-run.1.gz ./usr/share/bash-completion/completions/sphorge ./usr/share/doc/sphorge/copyright; do
        grep -qF " $file" <<<"$listed" || { echo "$package lacks $file" >&2 && return 1; }
    done
    if grep -vE '^[-d]r.{8} root/root' <<<"$listed"; then
        echo "these files of $package are not root's" >&2
        return 1
    fi
    rm -rf "$out/unpacked" && dpkg-deb --extract "$package" "$out/unpacked"
    (cd "$out" && unpacked/usr/bin/sphorge run block --set 'particles.spacing="10 mm"' --set time.max-steps=2 --quiet --overwrite -o "$out/run-of-the-package")
    rm -rf "$out/unpacked" "$tree" "$out/run-of-the-package"
    echo "$(basename "$package"): $(stat -c %s "$package") bytes"
}

# Packed, and built from what is packed, as `cargo publish` would before it sends anything.
crates() {
    cargo publish --dry-run --workspace --exclude sphorge-py --exclude sphorge-oracle --allow-dirty --locked --quiet
    # Where they lie depends on the version of Cargo, and some lie there twice.
    find target/package -name '*.crate' -printf '%f: %s bytes\n' | sort -u | grep .
}

for what in "${wanted[@]}"; do
    "$what"
done
