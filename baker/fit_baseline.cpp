// The fit's inner loops with 4 lane(s): see fit_kernel.inl.
#define LUMEL_LANES 4
#define LUMEL_KERNELS kBaselineKernels
#define LUMEL_NAME "baseline"
#include "fit_kernel.inl"
