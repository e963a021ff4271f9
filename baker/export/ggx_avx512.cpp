#define LUMEL_LANES 16
#define LUMEL_GGX kGgxAvx512
#include "ggx_kernel.inl"
