#!/usr/bin/env bash
# Every check there is, on the GPU path: formatting, lints, documentation, tests.
#
# Needs a Rust toolchain and a Vulkan driver. Where there is no driver it installs Mesa's lavapipe,
# which needs no GPU (apt only). Without any adapter it fails: nothing is skipped in silence.
#
# `hsad verify` runs on a second driver as well, SwiftShader, whose compiler and subgroups are others; Debian's package
# chromium has it. HSAD_SWIFTSHADER names its ICD file elsewhere. Where it is not installed, root and apt install it.
# The page in web/ is tested in that Chromium. `spirv-val` and `glslangValidator` check what the shaders are translated to,
# `groff` checks the manual pages, and all three are installed in the same way. The Python package is built, installed into a
# clean environment and tested there; HSAD_PYTHON names another interpreter, and HSAD_PYTHON_EXTRAS packages that its tests use where
# they are installed (rerun-sdk, open3d, torch, ray[data], ROS 2's), which are too large to be installed unasked. What is missing all the
# same is told as NOT RUN.
set -euo pipefail
cd "$(dirname "$0")"

# Mesa complains about a missing one in every process.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-/tmp}"

# With the time since the beginning, which is where minutes go.
say() { printf '\n== %s (%d:%02d)\n' "$*" $((SECONDS / 60)) $((SECONDS % 60)); }

# What a check can do without: where it cannot be installed, whoever asked for it says what was not run.
install() {
    if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
        apt-get update -qq && apt-get install -y -qq --no-install-recommends "$@" || true
    fi
}

command -v cargo >/dev/null || { echo 'test.sh: no cargo: install Rust from https://rustup.rs' >&2; exit 1; }
for component in fmt clippy; do
    cargo "$component" --version >/dev/null 2>&1 || rustup component add "${component/fmt/rustfmt}"
done

say 'formatting'
cargo fmt --all --check

say 'build'
cargo build --all-targets

say 'adapter'
hsad="${CARGO_TARGET_DIR:-target}/debug/hsad"
has_adapter() { "$hsad" features data/planes/left.png --device 0 >/dev/null; }
if ! has_adapter 2>/dev/null; then
    if command -v apt-get >/dev/null; then
        sudo=''
        [ "$(id -u)" -eq 0 ] || sudo='sudo'
        $sudo apt-get update -qq
        $sudo apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers libvulkan1
    else
        echo "test.sh: no Vulkan driver: install Mesa's (Fedora: mesa-vulkan-drivers, Arch: vulkan-swrast," \
            "Alpine: mesa-vulkan-swrast) and the Vulkan loader" >&2
    fi
fi
has_adapter
"$hsad" devices

say 'lints'
cargo clippy --all-targets -- -D warnings
# The library alone, as someone who embeds it builds it: no code depends on the backends, and with a test wgpu has the features of what was
# built above.
cargo clippy --lib --test documents --no-default-features --features backends -- -D warnings

say 'documentation'
RUSTDOCFLAGS='-D warnings' cargo doc --no-deps --lib --no-default-features
# With an example, and so with the features of what was built above.
RUSTDOCFLAGS='-D warnings' cargo doc --no-deps --lib --example registers

say 'tests'
[ -d "${HSAD_CASES:-../shared/cases}" ] || echo 'NOT RUN: the reported cases of ../shared/cases, or of HSAD_CASES, which are not there'
[ -d ../shared/data ] || echo 'NOT RUN: what needs the real pairs of ../shared/data, which is not there'
check_translations() { command -v spirv-val && command -v glslangValidator; } >/dev/null
if ! check_translations; then
    install spirv-tools glslang-tools
fi
check_translations || echo "NOT RUN: the checks of translated shaders by spirv-val and glslangValidator, not both of which" \
    "are installed (Debian: apt-get install spirv-tools glslang-tools): they are translated and not checked"
command -v groff >/dev/null || install groff-base
command -v groff >/dev/null ||
    echo 'NOT RUN: the check of manual pages by groff, which is not installed (Debian: apt-get install groff-base)'
cargo test

say 'regression suite'
verify() { "$hsad" verify -o "$(mktemp -d)/hsad-verify" "$@"; }
verify
# What GPUs get, as a whole.
verify --plan lanes --only balanced --only quality

say 'regression suite, on SwiftShader'
swiftshader="${HSAD_SWIFTSHADER:-/usr/lib/chromium/vk_swiftshader_icd.json}"
[ -f "$swiftshader" ] || install chromium
if [ -f "$swiftshader" ]; then
    VK_DRIVER_FILES="$swiftshader" verify --device swiftshader
    # Textures that lavapipe does not have.
    VK_DRIVER_FILES="$swiftshader" cargo test --test embedding -- --ignored
else
    echo "NOT RUN: there is no $swiftshader (Debian: apt-get install chromium), so one driver is all that was tested"
fi

say 'in the browser'
chromium="${HSAD_CHROMIUM:-chromium}"
if command -v "$chromium" >/dev/null; then
    rustup target add wasm32-unknown-unknown
    cargo clippy -p hsad-web --all-targets -- -D warnings
    cargo clippy -p hsad-web -p hsad --lib --no-default-features --target wasm32-unknown-unknown -- -D warnings
    cargo test -p hsad-web
    cargo test --test browser -- --ignored --nocapture
else
    echo "NOT RUN: there is no $chromium (Debian: apt-get install chromium, or HSAD_CHROMIUM names another one)," \
        "so the page was not tested"
fi

say 'in Python'
python="${HSAD_PYTHON:-python3}"
folder="$(mktemp -d)"
environment() { "$python" -m venv "$folder/$1" && "$folder/$1/bin/pip" install --quiet --disable-pip-version-check "${@:2}"; }
"$python" -c 'import ensurepip' 2>/dev/null || install python3 python3-venv
# The tools that build a wheel, and the environment of someone who has none.
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
    echo "NOT RUN: there is no Python 3.10 or later (HSAD_PYTHON names one), so the Python package was not built"
elif ! environment tools 'maturin>=1.16,<2' || ! environment user pytest mypy; then
    echo "NOT RUN: $python makes no environment with pip, or pip reaches no registry (Debian: apt-get install python3-venv), so the" \
        "Python package was not built"
else
    # Without the interpreter's path, which is another one each time; the feature makes it of what was compiled above.
    export PYO3_NO_PYTHON=1 PYO3_BUILD_EXTENSION_MODULE=1
    cargo clippy -p hsad-python --features workspace -- -D warnings
    "$folder/tools/bin/maturin" build -q -m python/Cargo.toml --profile dev --features workspace -i "$python" -o "$folder"
    user="$folder/user/bin"
    "$user/pip" install --quiet --disable-pip-version-check "$folder"/hsad-*.whl
    # What tests use where it is.
    # shellcheck disable=SC2086 # several packages
    "$user/pip" install --quiet --disable-pip-version-check opencv-python-headless nbclient ipykernel ${HSAD_PYTHON_EXTRAS:-} ||
        echo 'NOT RUN: what needs OpenCV, Jupyter or HSAD_PYTHON_EXTRAS, which pip does not install'
    (cd python && "$user/mypy")
    real="$PWD/../shared/data/stereo"
    # -rs tells what was skipped, with the reason.
    (
        [ ! -d "$real" ] || export HSAD_REAL_PAIRS="$real"
        PATH="$(realpath "$(dirname "$hsad")"):$PATH" "$user/python" -m pytest -q -rs -p no:cacheprovider python/tests
    )
    unset PYO3_NO_PYTHON PYO3_BUILD_EXTENSION_MODULE
fi
rm -r "$folder"

say 'done'
