#include "program.h"
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace lumel::cli {
namespace fs = std::filesystem;

namespace {

// Whether a process has a handler for SIGINT (proc(5)): not before it has started.
bool catchesInterrupts(pid_t process)
{
    std::ifstream status("/proc/" + std::to_string(process) + "/status");
    for (std::string word; status >> word;)
        if (word == "SigCgt:") {
            uint64_t signals = 0;
            status >> std::hex >> signals;
            return (signals >> (SIGINT - 1)) & 1;
        }
    return true; // it has ended
}

} // namespace

std::string readText(const fs::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

void writeText(const fs::path& file, const std::string& text)
{
    std::ofstream(file, std::ios::binary) << text;
}

void Program::SetUp()
{
    std::string pattern = (fs::temp_directory_path() / "lumel-cli-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    fs::create_directory(folder_ / "cache");
}

void Program::TearDown()
{
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

pid_t Program::start(const std::vector<std::string>& arguments)
{
    const pid_t child = fork();
    if (child != 0)
        return child;
    // In the child. Its output goes to the cache folder, so that tests can list folder_ without it.
    const auto redirect = [&](const char* name, int to) {
        const int file = open((folder_ / "cache" / name).c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        if (file < 0 || dup2(file, to) < 0)
            _exit(126);
    };
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
    std::vector<char*> argv{const_cast<char*>(LUMEL_PROGRAM)};
    for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (chdir(folder_.c_str()) == 0)
        execv(LUMEL_PROGRAM, argv.data());
    _exit(127);
}

Outcome Program::finish(pid_t child)
{
    Outcome outcome;
    int status = 0;
    if (child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status))
        outcome.exitCode = WEXITSTATUS(status);
    outcome.out = readText(folder_ / "cache" / "stdout");
    outcome.err = readText(folder_ / "cache" / "stderr");
    return outcome;
}

Outcome Program::run(const std::vector<std::string>& arguments)
{
    return finish(start(arguments));
}

Outcome Program::runAndInterrupt(const std::vector<std::string>& arguments, int milliseconds)
{
    const pid_t child = start(arguments);
    while (!catchesInterrupts(child))
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    kill(child, SIGINT);
    return finish(child);
}

void expectOneLine(const Outcome& outcome, int exitCode, const std::string& mentions)
{
    EXPECT_EQ(outcome.exitCode, exitCode) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_TRUE(!outcome.err.empty() && outcome.err.back() == '\n') << outcome.err;
    EXPECT_NE(outcome.err.find(mentions), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
}

} // namespace lumel::cli
