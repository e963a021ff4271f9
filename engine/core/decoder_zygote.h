// A zygote is a process that is made early, and forks one child for each task: the child starts in no time,
// with all libraries loaded, and with nothing of what the program has opened since.
#pragma once
#include "decoder_process.h"
#include "descriptor.h"

namespace lumel {

// Serves the requests that come over `control` until its parent is gone. In a process forked for it.
[[noreturn]] void runZygote(Descriptor control, pid_t parent, ChildHook hook);

} // namespace lumel
