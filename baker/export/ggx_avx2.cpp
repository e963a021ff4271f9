#define LUMEL_LANES 8
#define LUMEL_GGX kGgxAvx2
#include "ggx_kernel.inl"
