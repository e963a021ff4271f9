// A side's pictures on their way from the thread that renders to the window: copies, of which the window
// shows the last finished one while the next is rendered.
#pragma once
#include "renderer/frame.h"
#include <array>
#include <functional>
#include <mutex>

namespace lumel {

class PictureStream {
public:
    // Where the devices differ, pictures go through host memory.
    PictureStream(const gpu::Device& renders, const gpu::Device& shows) : renders_(renders), shows_(shows) {}

    // On the thread that renders: the picture of the renderer's last frame, RGBA8. Waits for the copy only
    // where pictures go through host memory.
    void write(Renderer& from);
    // The same, for a picture of the same view in another quality: it takes the last one's place bit by bit,
    // a step at each call of `next` until that says no. Where pictures do not go through host memory, a
    // budget costs little quality, and the picture is replaced at once.
    void fadeTo(Renderer& from, const std::function<bool()>& next);
    bool fresh() const; // there is one that has not been shown
    // On the window's thread: the last one written, in use transferRead until the next call; null: none.
    const gpu::Image* latest();
    void forget(); // on the window's thread

private:
    struct Slot {
        gpu::Image image; // of one device for both, with its copy's
        vk::raii::CommandBuffer commands = nullptr;
        vk::raii::Fence fence = nullptr;
        bool pending = false; // submitted and not waited for
        gpu::Buffer bytes;    // else
        vk::Extent2D size;
    };
    bool throughHost() const { return &renders_ != &shows_; }
    void copy(Renderer& from);
    void copyOnDevice(Renderer& from, Slot& slot);
    void publish();
    void upload(const Slot& slot);

    const gpu::Device& renders_;
    const gpu::Device& shows_;
    mutable std::mutex mutex_; // of the indices
    std::array<Slot, 3> slots_;
    size_t written_ = 0, ready_ = 1, shown_ = 2; // being written, the last one written, being shown
    bool fresh_ = false, any_ = false;           // `ready_` has not been shown; `shown_` has a picture
    gpu::Buffer staging_;
    gpu::Image uploaded_;
};

} // namespace lumel
