#include "shader_reload.h"
#include "core/error.h"
#include "core/file.h"
#include "pipeline.h"
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace lumel::gpu {
namespace {

// The sources that the program was built from, unless the environment names others.
std::string sourceFolder()
{
    const char* const folder = std::getenv("LUMEL_SHADERS");
    return folder ? folder : LUMEL_SHADERS;
}

// Runs the compiler with its output in `log`; its exit status, or -1 when there is none.
int compile(const std::string& source, const std::string& output, const std::string& log)
{
    const std::string include = "-I" + sourceFolder();
    const char* const arguments[] = {"glslangValidator", "--target-env",  "vulkan1.3",
                                     "--quiet",          include.c_str(), "-o",
                                     output.c_str(),     source.c_str(),  nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    pid_t child = 0;
    const int failed =
        posix_spawnp(&child, arguments[0], &actions, nullptr, const_cast<char* const*>(arguments), environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (failed != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status))
        return -1;
    return WEXITSTATUS(status);
}

// The compiler's first line that says what is wrong.
std::string firstError(const std::string& log)
{
    const auto bytes = readFile(log);
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const size_t at = text.find("ERROR:");
    text = at == std::string::npos ? text : text.substr(at);
    return text.substr(0, text.find('\n'));
}

// A folder that is gone with the object.
struct TemporaryFolder {
    TemporaryFolder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "lumel-shaders-XXXXXX").string();
        if (!mkdtemp(name.data()))
            throw Error("no temporary folder; set TMPDIR to one that can be written");
        path = name;
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
};

} // namespace

void reloadShaders()
{
    const TemporaryFolder folder;
    const std::string output = (folder.path / "code.spv").string(), log = (folder.path / "log").string();
    std::map<std::string, std::vector<uint32_t>> codes;
    for (const std::string& name : shaderNames()) {
        const std::string source = sourceFolder() + "/" + name;
        const int status = compile(source, output, log);
        if (status < 0)
            throw Error("glslangValidator not found; install glslang-tools");
        if (status > 0)
            throw Error(fmt::format("{}: {}", name, firstError(log)));
        const auto bytes = readFile(output);
        std::vector<uint32_t>& code = codes[name];
        code.resize(bytes.size() / sizeof(uint32_t));
        std::memcpy(code.data(), bytes.data(), code.size() * sizeof(uint32_t));
    }
    replaceShaderCode(std::move(codes));
}

} // namespace lumel::gpu
