// Limits that the baker, the engine and the shaders agree on, each named once.
#ifndef LUMEL_SHARED_LIMITS_H
#define LUMEL_SHARED_LIMITS_H
#include "compat.h"
LUMEL_SHARED_BEGIN

LUMEL_CONST float kPi = 3.14159265358979f;

// Powers (eigenvalues of the precision matrix P). Below 1 a lobe is wider than a cosine, which no
// gloss map asks for and where the fit turns flat; above 10000 the covariance 1/p = 1e-4 nears half
// float's subnormals (6.1e-5).
LUMEL_CONST float kMinPower = 1.0f;
LUMEL_CONST float kMaxPower = 10000.0f;

LUMEL_SHARED_END
#endif
