"""The adapter of the GPU that Ray has assigned to a worker.

Ray hides GPUs from CUDA by CUDA_VISIBLE_DEVICES, which Vulkan does not know. Its ids are NVIDIA's indices or UUIDs; both lead to a place on
the PCI bus, by which hsad names an adapter.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import hsad

_PROC = Path("/proc/driver/nvidia/gpus")
_NVIDIA = re.compile(r"(nvidia|geforce|quadro|tesla|titan|grid)\b", re.IGNORECASE)


def device_of_worker() -> str:
    """The device of this worker: that of the GPU that Ray has assigned, ``"best"`` where it has assigned none.

    Raises
    ------
    DeviceError
        The GPU has no adapter: its driver has no Vulkan, or the container does not show it. Or nothing tells which adapter it is.
    """
    assigned = _assigned()
    if not assigned:
        return "best"
    gpu = assigned[0]
    devices = hsad.devices()
    adapters = _places(devices)
    places = _by_nvidia_smi() or _by_proc() or _by_order(devices)
    place = places.get(gpu)
    if place is None:
        raise hsad.DeviceError(
            f"Ray has assigned GPU {gpu}, and nothing tells where it is (known: {', '.join(places) or 'none'}; shown: {', '.join(devices)}): "
            "name a device (device=...)"
        )
    if place not in adapters:
        raise hsad.DeviceError(
            f"Ray has assigned GPU {gpu} at {place}, and Vulkan shows no adapter there (shown: {', '.join(devices)}): install the "
            "driver's Vulkan part, in containers with NVIDIA_DRIVER_CAPABILITIES=all"
        )
    return f"pci:{place}"


def is_worker() -> bool:
    """Whether this process is one of Ray's workers."""
    ray = sys.modules.get("ray")
    return ray is not None and ray.is_initialized() and ray.get_runtime_context().worker.mode == ray.WORKER_MODE


def _assigned() -> list[str]:
    """Ids of the GPUs that Ray has assigned to this worker."""
    if not is_worker():
        return []
    return [str(gpu) for gpu in sys.modules["ray"].get_runtime_context().get_accelerator_ids().get("GPU", [])]


def _places(devices: list[str]) -> list[str]:
    """Places of adapters on the PCI bus, from their names in :func:`hsad.devices`."""
    found = (re.search(r"pci:([0-9a-f:.]+)\)$", device) for device in devices)
    return [match[1] for match in found if match]


def _by_nvidia_smi() -> dict[str, str]:
    """Places of GPUs by index and by UUID, as nvidia-smi tells; nothing where there is none."""
    command = ["nvidia-smi", "--query-gpu=index,uuid,pci.bus_id", "--format=csv,noheader"]
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    except (OSError, subprocess.SubprocessError):
        return {}
    return _from_smi(told)


def _from_smi(told: str) -> dict[str, str]:
    places = {}
    for line in told.splitlines():
        parts = [part.strip() for part in line.split(",")]
        if len(parts) == 3:
            index, uuid, place = parts
            places[index] = places[uuid] = _normal(place)
    return places


def _by_proc() -> dict[str, str]:
    """Places of GPUs by index and by UUID, as NVIDIA's driver for Linux tells; its indices follow the places."""
    places = {}
    entries = sorted(_PROC.iterdir(), key=lambda entry: _normal(entry.name)) if _PROC.is_dir() else []
    for index, entry in enumerate(entries):
        places[str(index)] = _normal(entry.name)
        try:
            information = (entry / "information").read_text(errors="replace")
        except OSError:
            continue
        uuid = re.search(r"^GPU UUID:\s*(\S+)", information, re.MULTILINE)
        if uuid:
            places[uuid[1]] = places[str(index)]
    return places


def _by_order(devices: list[str]) -> dict[str, str]:
    """Places of adapters by index, in the order of the bus; nothing where others than NVIDIA's, which Ray may not count, are among them."""
    places = sorted(_places(devices))
    others = [device for device in devices if _places([device]) and not _NVIDIA.match(device)]
    return {} if others and len(places) > 1 else {str(index): place for index, place in enumerate(places)}


def _normal(place: str) -> str:
    """A place as Vulkan's adapters have it: the domain of four digits, in small letters."""
    domain, _, rest = place.strip().lower().partition(":")
    return f"{int(domain, 16):04x}:{rest}"


def limit_threads() -> None:
    """Holds Mesa's software driver to the CPUs that Ray has assigned to this worker; before a device is opened."""
    cpus = os.environ.get("OMP_NUM_THREADS", "")
    if is_worker() and cpus.isdigit() and int(cpus) > 0:
        os.environ.setdefault("LP_NUM_THREADS", cpus)
