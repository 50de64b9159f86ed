#!/usr/bin/env bash
# Fetches real stereo pairs with ground truth from package registries, in the layout of data/ (see data/README.md).
#
#   scripts/fetch-real-pairs.sh FOLDER           Motorcycle (741x500; scikit-image's wheel from PyPI, 12 MB)
#   scripts/fetch-real-pairs.sh --aloe FOLDER    Aloe as well (1282x1110; Debian's opencv-doc, 96 MB; needs apt)
set -euo pipefail

readonly WHEEL='scikit-image==0.17.2'
readonly TERMS='Middlebury: We grant permission to use and publish all images and disparity maps on this website. However, if you use our datasets, we request that you cite the appropriate paper(s)'

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
readonly here

usage() {
    sed -n '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
}

fail() {
    echo "fetch-real-pairs: $*" >&2
    exit 1
}

# need COMMAND HINT: stops with the hint if the command is missing.
need() {
    command -v "$1" > /dev/null || fail "there is no '$1' here: $2"
}

# check FILE SHA256: stops if the file is missing or its checksum differs.
check() {
    [[ -f $1 ]] || fail "$1 is not in the package: its contents have changed"
    local found
    found=$(sha256sum "$1" | cut -d ' ' -f 1)
    [[ $found == "$2" ]] || fail "$1 has sha256 $found, not $2: the package has changed or the download is damaged"
}

# deliver SCENE: moves a complete scene from the scratch folder to its place.
deliver() {
    rm -rf "${folder:?}/$1"
    mv "$scratch/$1" "$folder/$1"
    echo "$folder/$1"
}

fetch_motorcycle() {
    python3 -m pip --version > /dev/null 2>&1 || fail "python3 has no pip: install python3-pip, or run in a venv"
    python3 -m pip download --quiet --no-deps --only-binary :all: --python-version 38 \
        --platform manylinux1_x86_64 --dest "$scratch" "$WHEEL" ||
        fail "pip could not download $WHEEL: is PyPI, or the mirror that pip is configured for, within reach?"
    local wheels=("$scratch"/scikit_image-*.whl)
    python3 -m zipfile -e "${wheels[0]}" "$scratch/wheel"

    local from=$scratch/wheel/skimage/data scene=$scratch/Motorcycle
    check "$from/motorcycle_left.png" db18e9c4157617403c3537a6ba355dfeafe9a7eabb6b9b94cb33f6525dd49179
    check "$from/motorcycle_right.png" 5fc913ae870e42a4b662314bc904d1786bcad8e2f0b9b67dba5a229406357797
    check "$from/motorcycle_disp.npz" 2e49c8cebff3fa20359a0cc6880c82e1c03bbb106da81a177218281bc2f113d7
    mkdir "$scene"
    cp "$from/motorcycle_left.png" "$scene/left.png"
    cp "$from/motorcycle_right.png" "$scene/right.png"
    # The calibration is from the documentation of skimage.data.stereo_motorcycle.
    python3 "$here/convert-truth.py" "$from/motorcycle_disp.npz" "$scene" \
        "dataset=Middlebury 2014 Motorcycle, a quarter of the full size" \
        "source=PyPI $WHEEL: skimage/data/motorcycle_{left.png,right.png,disp.npz}" \
        "licence=$TERMS (Scharstein et al., GCPR 2014)" \
        focal_px=994.978 baseline_mm=193.001 doffs_px=31.086
    deliver Motorcycle
}

fetch_aloe() {
    need apt-get "Aloe comes from a Debian package; on another system unpack opencv-doc_4.6.0*.deb by hand"
    need dpkg-deb "it belongs to Debian's dpkg"
    (cd "$scratch" && apt-get -qq download opencv-doc 2> apt.log) ||
        fail "apt-get download opencv-doc: $(tail -n 1 "$scratch/apt.log"); try apt-get update first"
    dpkg-deb --extract "$scratch"/opencv-doc_*.deb "$scratch/opencv-doc"

    local from=$scratch/opencv-doc/usr/share/doc/opencv-doc/examples/data scene=$scratch/Aloe
    check "$from/aloeL.jpg" cce5736808efe80d9f04b118dbb978c344d4345672b332718c3e039a3eeb8eee
    check "$from/aloeR.jpg" 9b23100df31a846bc6e6a6545563b2b4120b948c9835c7d36cde00af77f4503e
    check "$from/aloeGT.png" 39ce4f3cb48d797d1091c5152f93361d8104298c337f8a1c134d87dda3442c04
    mkdir "$scene"
    cp "$from/aloeL.jpg" "$scene/left.jpg"
    cp "$from/aloeR.jpg" "$scene/right.jpg"
    # Focal length and baseline are left out: the views are cropped by different, unknown amounts, so that depth cannot be
    # computed from them.
    python3 "$here/convert-truth.py" "$from/aloeGT.png" "$scene" \
        "dataset=Middlebury 2006 Aloe, full size, the pictures as JPEG, the truth in whole pixels" \
        "source=Debian opencv-doc: examples/data/aloe{L.jpg,R.jpg,GT.png}" \
        "licence=$TERMS (Scharstein and Pal, CVPR 2007)"
    deliver Aloe
}

aloe=no
folder=
for argument in "$@"; do
    case $argument in
        -h | --help) usage && exit ;;
        --aloe) aloe=yes ;;
        -*) fail "there is no option '$argument'; the only one is --aloe" ;;
        *)
            [[ -z $folder ]] || fail "one folder, not '$folder' and '$argument'"
            folder=$argument
            ;;
    esac
done
if [[ -z $folder ]]; then
    usage >&2
    exit 2
fi

need python3 "install Python 3.9 or newer"
need sha256sum "it belongs to the GNU coreutils"
mkdir -p "$folder"
# The scratch folder lies inside the target folder, so that a complete scene is moved, not copied.
scratch=$(mktemp -d "$folder/.fetch.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
fetch_motorcycle
if [[ $aloe == yes ]]; then
    fetch_aloe
fi
