"""The exceptions of hsad; their messages are sentences with the value, the limit and the way out."""


class Error(Exception):
    """Whatever hsad itself refuses."""


class ParameterError(Error, ValueError):
    """A parameter outside its range, views of different sizes, or a picture that is too small."""


class FormatError(Error, ValueError):
    """A file or a picture whose content contradicts its format."""


class NotRectifiedError(Error):
    """A pair whose rows do not correspond, or that cannot be rectified."""


class NoRangeError(Error):
    """The disparity range could not be found."""


class DeviceError(Error, RuntimeError):
    """No device of that name, a device that cannot run this, that was lost or ran out of memory, or a forked process."""


class DeviceLostError(DeviceError):
    """The driver gave the device up: this process can use it no more."""


class ForkError(DeviceError):
    """The process was forked after hsad had begun to work in its parent."""
