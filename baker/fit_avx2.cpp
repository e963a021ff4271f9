// The fit's inner loops with 8 lane(s): see fit_kernel.inl.
#define LUMEL_LANES 8
#define LUMEL_KERNELS kAvx2Kernels
#define LUMEL_NAME "avx2"
#include "fit_kernel.inl"
