#define LUMEL_LANES 1
#define LUMEL_GGX kGgxScalar
#include "ggx_kernel.inl"
