"""The kernels that can be asked for by name."""

from __future__ import annotations

from postproc.averaging.coarse.kernels.gaussian import Gaussian
from postproc.averaging.coarse.kernels.heaviside import Heaviside
from postproc.averaging.coarse.kernels.kernel import Kernel
from postproc.averaging.coarse.kernels.lucy import Lucy

KERNELS: dict[str, type[Kernel]] = {
    "lucy": Lucy,
    "gaussian": Gaussian,
    "heaviside": Heaviside,
}
