// The fit's inner loops with 1 lane(s): see fit_kernel.inl.
#define LUMEL_LANES 1
#define LUMEL_KERNELS kScalarKernels
#define LUMEL_NAME "scalar"
#include "fit_kernel.inl"
