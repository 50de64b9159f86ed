#!/bin/sh
# Everything that a real GPU can show, in one run: the tests, the regression suite, the fastest kernels, and the times of every
# preset by both plans of semi-global matching and by the plan that was found to be the fastest.
#
#     scripts/on-a-gpu.sh DEVICE FOLDER
#
# DEVICE is the index or a part of the name of a device (hsad devices). FOLDER receives verify-PLAN.json, tune.json, and bench-PLAN.json and its
# table for each plan; hsad keeps nothing outside it. The tests run on the best device, as everything that has no --device does.
# SIZES, RUNS: picture sizes and runs of each preset in place of those below. HSAD: the program, in place of a build; then no tests.
set -eu
device="${1:?DEVICE, the index or a part of the name of a device}"
mkdir -p "${2:?FOLDER for the figures}"
folder="$(cd "$2" && pwd)"
program="${HSAD:-target/release/hsad}"
case "$program" in /*) ;; */*) program="$(pwd)/$program" ;; esac
cd "$(dirname "$0")/.."
sizes=""
for size in ${SIZES:-640x480 1242x375 1920x1080}; do sizes="$sizes --size $size"; done
[ -n "${HSAD:-}" ] || { cargo build --release && program="$(pwd)/target/release/hsad"; }
export XDG_CACHE_HOME="$folder/cache"
hsad() { "$program" "$@"; }
# $1: the name of the run; the rest: its options.
bench() {
    name="$1"
    shift
    # shellcheck disable=SC2086 # $sizes is a list of options
    hsad bench --device "$device" --runs "${RUNS:-100}" $sizes --disparities 128 --disparities 256 \
        --json "$folder/bench-$name.json" "$@" | tee "$folder/bench-$name.txt"
}

hsad devices
for plan in lanes lines; do
    hsad verify --device "$device" --plan "$plan" --json "$folder/verify-$plan.json" -o "$folder/failures-$plan"
    bench "$plan" --plan "$plan"
done
hsad tune --device "$device" --json "$folder/tune.json" | tee "$folder/tune.txt"
bench tuned --compare "$folder/bench-lanes.json"
[ -n "${HSAD:-}" ] || cargo test --release --test kernels --test embedding
