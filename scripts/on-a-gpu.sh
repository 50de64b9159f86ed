#!/bin/sh
# Everything that a real GPU can show, in one run: the tests, the regression suite and the times of every preset by both
# plans of semi-global matching.
#
#     scripts/on-a-gpu.sh DEVICE FOLDER
#
# DEVICE is the index or a part of the name of a device (hsad devices). FOLDER receives verify-PLAN.json, and bench-PLAN.json and its
# table for each plan. The tests run on the best device, as everything that has no --device does.
set -eu
device="${1:?DEVICE, the index or a part of the name of a device}"
folder="${2:?FOLDER for the figures}"
cd "$(dirname "$0")/.."
mkdir -p "$folder"
hsad() { "${HSAD:-target/release/hsad}" "$@"; }
[ -n "${HSAD:-}" ] || cargo build --release

hsad devices
for plan in lanes lines; do
    hsad verify --device "$device" --plan "$plan" --json "$folder/verify-$plan.json" -o "$folder/failures-$plan"
    hsad bench --device "$device" --plan "$plan" --json "$folder/bench-$plan.json" --runs 100 \
        --size 640x480 --size 1242x375 --size 1920x1080 --disparities 128 | tee "$folder/bench-$plan.txt"
    hsad bench --device "$device" --plan "$plan" --json "$folder/bench-$plan-256.json" --runs 50 \
        --size 1920x1080 --disparities 256 | tee "$folder/bench-$plan-256.txt"
done
[ -n "${HSAD:-}" ] || cargo test --release --test kernels --test embedding
