// OpenImageIO 2.4's PNG reader loses its message when libpng jumps out of a truncated file: 31 bytes for
// each such file. In the scope of this object the leak checker looks away; everything else is checked.
#pragma once
#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace lumel {
#ifdef __SANITIZE_ADDRESS__
using IgnoreOiioLeak = __lsan::ScopedDisabler;
#else
struct IgnoreOiioLeak {
    IgnoreOiioLeak() {} // not trivial: no warning about an unused variable
};
#endif
} // namespace lumel
