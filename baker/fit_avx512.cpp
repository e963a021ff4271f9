// The fit's inner loops with 16 lane(s): see fit_kernel.inl.
#define LUMEL_LANES 16
#define LUMEL_KERNELS kAvx512Kernels
#define LUMEL_NAME "avx512"
#include "fit_kernel.inl"
