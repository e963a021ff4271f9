#define LUMEL_LANES 4
#define LUMEL_GGX kGgxBaseline
#include "ggx_kernel.inl"
