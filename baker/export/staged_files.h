// Files of one folder that appear together: written to a folder beside them, then renamed.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace lumel::baker {

class StagedFiles {
public:
    // Makes the folder where only that is missing. Throws Error when it cannot be written.
    explicit StagedFiles(std::filesystem::path folder);
    ~StagedFiles(); // removes what was not published, and the folder if it was made here
    StagedFiles(const StagedFiles&) = delete;
    StagedFiles& operator=(const StagedFiles&) = delete;

    // Where to write a file that is to be called `name`, which may lie in a folder below.
    std::filesystem::path path(const std::string& name);
    void write(const std::string& name, std::span<const std::byte> bytes);
    void write(const std::string& name, const std::string& text);
    // Renames all of them. Throws Error.
    void publish();

    const std::vector<std::string>& names() const { return names_; }
    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path folder_, temporary_;
    std::vector<std::string> names_;
    bool madeFolder_ = false;
};

} // namespace lumel::baker
