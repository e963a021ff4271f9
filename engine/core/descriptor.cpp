#include "descriptor.h"
#include <filesystem>
#include <new>
#include <sys/mman.h>
#include <unistd.h>

namespace lumel {

Descriptor::~Descriptor()
{
    if (number_ >= 0)
        close(number_);
}

Mapping::Mapping(const Descriptor& file, size_t size, Access access)
{
    if (size == 0)
        return;
    const int protection = access == write ? PROT_READ | PROT_WRITE : PROT_READ;
    void* at = mmap(nullptr, size, protection, MAP_SHARED, file.get(), 0);
    if (at == MAP_FAILED)
        throw std::bad_alloc();
    bytes_ = {static_cast<std::byte*>(at), size};
}

Mapping::~Mapping()
{
    if (!bytes_.empty())
        munmap(bytes_.data(), bytes_.size());
}

size_t threadCount()
{
    size_t count = 0;
    for ([[maybe_unused]] const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
        ++count;
    return count;
}

} // namespace lumel
