// When a window shows a finished picture.
#pragma once

namespace lumel::gpu {

enum class PresentMode { fifo, mailbox, immediate }; // fifo waits for the display (vsync)

} // namespace lumel::gpu
