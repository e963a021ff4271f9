// Runs build/lumel as a shell does, in a separate folder.
#pragma once
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <sys/types.h>
#include <vector>

namespace lumel::cli {

struct Outcome {
    int exitCode = -1; // -1: ended by a signal
    std::string out, err;
};

// Each test gets an empty folder, which is the program's working directory and holds its cache; it is
// removed afterwards.
class Program : public ::testing::Test {
protected:
    void SetUp() override;
    void TearDown() override;

    Outcome run(const std::vector<std::string>& arguments);
    // Sends SIGINT as soon as the program has run for `milliseconds`.
    Outcome runAndInterrupt(const std::vector<std::string>& arguments, int milliseconds);

    // In two steps, for tests that do something meanwhile.
    pid_t start(const std::vector<std::string>& arguments);
    Outcome finish(pid_t child);

    std::filesystem::path folder_;
};

std::string readText(const std::filesystem::path& file);
void writeText(const std::filesystem::path& file, const std::string& text);

// One line on stderr that names the file, nothing on stdout.
void expectOneLine(const Outcome& outcome, int exitCode, const std::string& mentions);

} // namespace lumel::cli
