// By hand, some ten minutes: cli_tests --gtest_also_run_disabled_tests --gtest_filter='*DISABLED_Damage*'
#include "../image_files.h"
#include "program.h"
#include <chrono>
#include <csignal>
#include <cstdio>
#include <sys/wait.h>
#include <thread>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr int kWays = 257; // a format: 1799 in all

struct Counts {
    int read = 0, refused = 0, crashed = 0, hung = 0, notOneLine = 0, leftOutput = 0;
    int died = 0, tooLong = 0, tooMuch = 0; // of the refused: what became of the decoder
};

class DISABLED_DamagedImages : public Program, public testing::WithParamInterface<const char*> {
protected:
    size_t below(size_t bound)
    {
        random_ = random_ * 6364136223846793005u + 1442695040888963407u; // Knuth, MMIX
        return size_t(random_ >> 33) % bound;
    }

    std::string damaged(std::string bytes, int way)
    {
        const size_t size = bytes.size(), early = std::min<size_t>(size, 600);
        const size_t at = below(way % 2 ? size : early), length = std::min(1 + below(64), size - at);
        switch (way % 8) {
        case 0:
            return bytes.substr(0, below(size)); // cut
        case 1:
            bytes[at] = char(below(256));
            break;
        case 2:
            bytes[at] ^= char(1 << below(8));
            break;
        case 3: // several
            for (int i = 0; i < 20; ++i)
                bytes[below(size)] = char(below(256));
            break;
        case 4:
            bytes.replace(at, length, length, way % 16 < 8 ? '\0' : '\xff');
            break;
        case 5:
            bytes.erase(at, length);
            break;
        case 6:
            bytes.insert(at, bytes.substr(below(size), length));
            break;
        default: // sizes, counts and offsets that lie
            for (size_t i = at; i < std::min(at + 4, size); ++i)
                bytes[i] = "\x7f\xff\x00\x01"[below(4)];
        }
        return bytes;
    }

    // Nothing when it takes more than a minute.
    std::optional<Outcome> runWithin(const std::vector<std::string>& arguments)
    {
        const pid_t program = start(arguments);
        const auto end = std::chrono::steady_clock::now() + 60s;
        siginfo_t info{};
        while (info.si_pid == 0 && std::chrono::steady_clock::now() < end) {
            std::this_thread::sleep_for(5ms);
            waitid(P_PID, id_t(program), &info, WEXITED | WNOHANG | WNOWAIT);
        }
        if (info.si_pid == 0)
            kill(program, SIGKILL);
        const Outcome outcome = finish(program);
        return info.si_pid == 0 ? std::nullopt : std::optional(outcome);
    }

    void judge(const std::string& name, Counts& counts)
    {
        const auto outcome = runWithin(
            {"bake", "--height", name, "--method", "height", "--height-scale", "0.02", "-o", "o.exr"});
        const bool wrote = fs::remove(folder_ / "o.exr");
        const auto says = [&](const char* words) { return outcome->err.find(words) != std::string::npos; };
        if (!outcome) {
            ++counts.hung;
        } else if (outcome->exitCode == 0) {
            ++counts.read;
        } else if (outcome->exitCode != 1) {
            ++counts.crashed;
        } else {
            ++counts.refused;
            counts.notOneLine += std::count(outcome->err.begin(), outcome->err.end(), '\n') != 1 ||
                                 outcome->err.rfind("lumel: " + name + ": ", 0) != 0;
            counts.leftOutput += wrote;
            counts.died += says("its decoder ended");
            counts.tooLong += says("takes longer");
            counts.tooMuch += says("takes more memory");
        }
        if (!outcome || (outcome->exitCode != 0 && outcome->exitCode != 1) || says("its decoder ended"))
            std::printf("  %s: %s", name.c_str(), outcome ? (outcome->err + "\n").c_str() : "hangs\n");
    }

    uint64_t random_ = 1;
};

TEST_P(DISABLED_DamagedImages, EndInAPictureOrOneLine)
{
    const std::string name = std::string("a.") + GetParam();
    test::writeImageFile(folder_ / name, 48, 40, OIIO::TypeDesc::UINT8, true);
    const std::string whole = test::bytesOf(folder_ / name);
    Counts c;
    for (int way = 0; way < kWays; ++way) {
        test::writeBytes(folder_ / name, damaged(whole, way));
        judge(name, c);
    }
    std::printf(
        "%s: %d read, %d refused, %d crashed, %d hung, %d not one line, %d left output; of the refused "
        "%d decoders died, %d took too long, %d too much memory\n",
        GetParam(), c.read, c.refused, c.crashed, c.hung, c.notOneLine, c.leftOutput, c.died, c.tooLong,
        c.tooMuch);
    EXPECT_EQ(c.crashed + c.hung + c.notOneLine + c.leftOutput, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, DISABLED_DamagedImages, testing::ValuesIn(test::kReadEndings),
                         [](const auto& format) { return std::string(format.param); });

} // namespace
} // namespace lumel::cli
