// Images are decoded in processes that may die, and that can open nothing.
#include "../../image_files.h"
#include "core/decode.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "core/progress.h"
#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>
#include <unistd.h>

namespace lumel {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

struct Decoding : testing::Test {
    fs::path folder;

    Decoding()
    {
        std::string pattern = (fs::temp_directory_path() / "lumel-decoder-XXXXXX").string();
        folder = mkdtemp(pattern.data());
    }
    ~Decoding() override { fs::remove_all(folder); }

    // What is said of a file; empty if it is read.
    static std::string refusal(const fs::path& file)
    {
        try {
            readImage(file);
            return "";
        } catch (const Error& e) {
            const std::string message = e.what();
            EXPECT_EQ(message.rfind(file.string() + ": ", 0), 0u) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            return message;
        }
    }
    std::string refusalOf(const std::string& bytes, const std::string& name = "test.png") const
    {
        return refusal(test::writeBytes(folder / name, bytes));
    }
    static bool contains(const std::string& text, const std::string& part)
    {
        return text.find(part) != std::string::npos;
    }

    static Image decodedHere(const fs::path& file)
    {
        const auto bytes = readFile(file);
        std::vector<std::byte> storage;
        DecodeRequest request;
        request.namedTga = file.extension() == ".tga";
        const DecodedShape shape = decode(bytes, request, [&](const DecodedShape& known) {
            storage.resize(known.samples() * bytesOf(known.type));
            return storage.data();
        });
        Image image(shape.width, shape.height, shape.channels);
        toFloats(storage.data(), shape.type, image.pixels);
        return image;
    }
    // By OpenImageIO's own conversion to floats.
    static Image readByOiio(const fs::path& file)
    {
        const auto input = OIIO::ImageInput::open(file.string());
        const OIIO::ImageSpec spec = input->spec();
        Image image(spec.width, spec.height, spec.nchannels);
        EXPECT_TRUE(input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()));
        return image;
    }
};

TEST_F(Decoding, GivesThePixelsThatDecodingHereGives)
{
    for (const char* ending : test::kReadEndings) {
        const fs::path file = folder / (std::string("a.") + ending);
        test::writeImageFile(file, 61, 37);
        const Image read = readImage(file);
        EXPECT_EQ(read.width, 61) << ending;
        EXPECT_EQ(read.height, 37) << ending;
        EXPECT_EQ(read.channels, 3) << ending;
        EXPECT_TRUE(read.pixels == decodedHere(file).pixels) << ending;
        EXPECT_TRUE(read.pixels == readByOiio(file).pixels) << ending;
    }
    for (const auto& [ending, type] : {std::pair("png", OIIO::TypeDesc::UINT16),
                                       {"tif", OIIO::TypeDesc::UINT16},
                                       {"tif", OIIO::TypeDesc::FLOAT},
                                       {"exr", OIIO::TypeDesc::FLOAT},
                                       {"exr", OIIO::TypeDesc::HALF},
                                       {"tif", OIIO::TypeDesc::UINT32}}) {
        const fs::path file = folder / (std::string("b.") + ending);
        test::writeImageFile(file, 61, 37, type);
        EXPECT_TRUE(readImage(file).pixels == readByOiio(file).pixels) << ending << " " << type;
    }
}

TEST_F(Decoding, SeveralImagesAtOnceAreNotMixedUp)
{
    std::vector<fs::path> files;
    for (const char* ending : test::kReadEndings)
        test::writeImageFile(files.emplace_back(folder / (std::string("a.") + ending)), 61, 37);
    std::atomic<int> good = 0;
    std::vector<std::thread> threads;
    for (size_t i = 0; i < 3 * files.size(); ++i)
        threads.emplace_back([&, i] {
            const fs::path& file = files[i % files.size()];
            good += readImage(file).pixels == decodedHere(file).pixels;
        });
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(good, 3 * int(files.size()));
}

// Two that never end do not keep a third from being decoded.
TEST_F(Decoding, OneImageDoesNotWaitForAnother)
{
    test::writeImageFile(folder / "a.png", 16, 16);
    const fs::path busy = test::writeBytes(folder / "busy.png", "TEST work");
    std::atomic<int> cut = 0;
    std::vector<std::thread> threads;
    for (int i = 0; i < 2; ++i)
        threads.emplace_back([&] { cut += contains(refusal(busy), "longer"); });
    std::this_thread::sleep_for(100ms);
    EXPECT_EQ(readImage(folder / "a.png").width, 16);
    EXPECT_EQ(cut, 0);
    for (std::thread& thread : threads)
        thread.join();
    EXPECT_EQ(cut, 2);
}

TEST_F(Decoding, TruncatedFilesOfEachFormatAreRefused)
{
    for (const char* ending : test::kReadEndings) {
        const std::string name = std::string("a.") + ending;
        test::writeImageFile(folder / name, 64, 64);
        const std::string whole = test::bytesOf(folder / name);
        for (const double share : {0.05, 0.3, 0.6, 0.9})
            EXPECT_TRUE(
                contains(refusalOf(whole.substr(0, size_t(share * double(whole.size()))), name), "; "))
                << ending << " " << share;
    }
}

// Bytes flipped, zeroed and set, pieces doubled: an image or one line, and the next one is read all the same.
TEST_F(Decoding, DamagedFilesOfEachFormatEndInAnImageOrALine)
{
    uint32_t random = 7;
    const auto below = [&](size_t bound) {
        random = random * 1664525u + 1013904223u;
        return size_t(random >> 8) % bound;
    };
    for (const char* ending : test::kReadEndings) {
        const std::string name = std::string("a.") + ending;
        test::writeImageFile(folder / name, 32, 32);
        const std::string whole = test::bytesOf(folder / name);
        for (int way = 0; way < 24; ++way) {
            std::string bytes = whole;
            const size_t reach = way % 2 ? bytes.size() : std::min<size_t>(bytes.size(), 200);
            for (int i = 0; i <= way / 4; ++i)
                bytes[below(reach)] = char(way % 3 == 0 ? 0 : way % 3 == 1 ? 255 : int(below(256)));
            if (way % 8 == 7)
                bytes.insert(below(reach), whole.substr(0, 100));
            refusalOf(bytes, name);
        }
        EXPECT_EQ(refusalOf(whole, name), "");
    }
}

TEST_F(Decoding, HeadersThatLieAboutTheSizeAreRefused)
{
    const auto patched = [&](const char* ending, size_t at, const std::string& with) {
        const std::string name = std::string("a.") + ending;
        test::writeImageFile(folder / name, 64, 64);
        std::string bytes = test::bytesOf(folder / name);
        bytes.replace(at, with.size(), with);
        EXPECT_NE(refusalOf(bytes, name), "") << ending;
    };
    patched("tga", 12, "\xff\xff\xff\xff");       // 65535 x 65535
    patched("tga", 14, std::string("\x80\0", 2)); // 128 rows, of which 64 are there
    patched("webp", 26, "\xff\x3f\xff\x3f");      // RFC 9649, section 2.5: 16383 x 16383
    test::writeImageFile(folder / "a.hdr", 64, 64);
    std::string hdr = test::bytesOf(folder / "a.hdr");
    hdr.replace(hdr.find("-Y 64 +X 64"), 11, "-Y 99999 +X 99999");
    EXPECT_NE(refusalOf(hdr, "a.hdr"), "");
    test::writeImageFile(folder / "a.jpg", 64, 64);
    std::string jpeg = test::bytesOf(folder / "a.jpg");
    jpeg.replace(jpeg.find("\xff\xc0") + 5, 4, "\x3f\xff\x3f\xff"); // 16383 x 16383 in 2 KB
    EXPECT_TRUE(contains(refusalOf(jpeg, "a.jpg"), "cannot be in"));
}

TEST_F(Decoding, FormatsThatAreNotReadAreRefusedByContent)
{
    for (const char* format : {"bmp", "ico", "gif", "dds"})
        for (const char* name : {"a.png", "a.tga", "a.exr"})
            EXPECT_TRUE(
                contains(refusalOf(test::foreignFile(format, folder), name), "its content is not PNG"))
                << format << " named " << name;
}

TEST_F(Decoding, NamesDoNotMatter)
{
    for (const char* ending : test::kReadEndings) {
        test::writeImageFile(folder / (std::string("a.") + ending), 16, 16);
        fs::copy_file(folder / (std::string("a.") + ending), folder / "other.name",
                      fs::copy_options::overwrite_existing);
        EXPECT_EQ(refusal(folder / "other.name"), "") << ending; // OpenImageIO's TGA has the footer
    }
}

TEST_F(Decoding, TgaWithoutItsFooterIsToldByItsName)
{
    test::writeImageFile(folder / "a.tga", 16, 16);
    const std::string whole = test::bytesOf(folder / "a.tga");
    const std::string first = whole.substr(0, 18 + 16 * 16 * 3); // as version 1 of the format ends
    EXPECT_EQ(refusalOf(first, "b.tga"), "");
    EXPECT_EQ(refusalOf(first, "b.TGA"), "");
    EXPECT_TRUE(contains(refusalOf(first, "b.png"), "its content is not"));
    EXPECT_TRUE(contains(refusalOf(std::string(18, '\0') + first, "b.tga"), "its content is not"));
}

TEST_F(Decoding, GltfImagesArePngJpegOrWebp)
{
    for (const char* ending : test::kReadEndings) {
        test::writeImageFile(folder / (std::string("a.") + ending), 16, 16);
        const auto bytes = readFile(folder / (std::string("a.") + ending));
        const std::string format = ending;
        if (format == "png" || format == "jpg" || format == "webp")
            EXPECT_EQ(readImage(bytes, "a.gltf#image0", kGltfImageFormats).width, 16) << ending;
        else
            EXPECT_THROW(readImage(bytes, "a.gltf#image0", kGltfImageFormats), Error) << ending;
    }
}

TEST_F(Decoding, ChildrenMayDie)
{
    EXPECT_TRUE(contains(refusalOf("TEST killed"), "damaged image (its decoder ended: Killed)"));
    EXPECT_TRUE(contains(refusalOf("TEST leave"), "damaged image (its decoder ended: no reply)"));
    EXPECT_TRUE(contains(refusalOf("TEST crash"), "damaged image (its decoder ended: "));
    test::writeImageFile(folder / "a.png", 16, 16);
    EXPECT_EQ(refusal(folder / "a.png"), "") << "the next one suffers";
}

TEST_F(Decoding, AnOverflowOfOpenImageIosStackIsALine)
{
    test::writeImageFile(folder / "a.png", 16, 16);
    EXPECT_TRUE(contains(refusalOf(test::withNestedMetadata(test::bytesOf(folder / "a.png")), "nested.png"),
                         "damaged image (its decoder ended: "));
}

TEST_F(Decoding, MessagesAreOneLineOfPrintableText)
{
    EXPECT_EQ(refusalOf("TEST lines"), (folder / "test.png").string() + ": one?two?[31m");
}

TEST_F(Decoding, ProcessorTimeIsLimited)
{
    const auto start = Clock::now();
    EXPECT_TRUE(contains(refusalOf("TEST work"), "damaged image (decoding it takes longer"));
    EXPECT_LT(Clock::now() - start, 60s);
}

TEST_F(Decoding, JpegBombsAreCut)
{
    EXPECT_EQ(refusalOf(test::jpegBomb(512, 10), "harmless.jpg"), "");
    const auto start = Clock::now(); // some 20 s without a limit
    EXPECT_TRUE(contains(refusalOf(test::jpegBomb(4096, 20000), "bomb.jpg"), "takes longer"));
    EXPECT_LT(Clock::now() - start, 60s);
}

#ifndef __SANITIZE_ADDRESS__ // which needs all the address space that there is
TEST_F(Decoding, MemoryIsLimited)
{
    EXPECT_TRUE(contains(refusalOf("TEST eat"), "damaged image (decoding it takes more memory"));
}
#endif

TEST_F(Decoding, ChildrenCanOpenNothing)
{
    std::string expected = ": ";
    for (const char* way : {"open", "create", "socket", "fork", "unlink", "kill", "execute", "code"})
        expected += std::string(way) + ": EPERM, ";
#ifndef __SANITIZE_ADDRESS__ // which needs some
    expected += "descriptors: 0";
#endif
    EXPECT_TRUE(refusalOf("TEST escape").starts_with((folder / "test.png").string() + expected))
        << refusalOf("TEST escape");
    EXPECT_FALSE(fs::exists("/tmp/lumel-escaped"));
}

// In processes of their own, which end.
TEST_F(Decoding, WithoutItsZygoteEachImageIsALine)
{
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    test::writeImageFile(folder / "a.png", 16, 16);
    EXPECT_EXIT(
        {
            kill(DecoderProcess::id(), SIGKILL);
            std::exit(contains(refusal(folder / "a.png"), "the image decoder's process has ended") &&
                              contains(refusal(folder / "a.png"), "the image decoder's process has ended")
                          ? 0
                          : 1);
        },
        testing::ExitedWithCode(0), "");
    // While it decodes.
    test::writeBytes(folder / "busy.png", "TEST work");
    EXPECT_EXIT(
        {
            std::thread killer([] {
                std::this_thread::sleep_for(200ms);
                kill(DecoderProcess::id(), SIGKILL);
            });
            const std::string message = refusal(folder / "busy.png");
            killer.join();
            std::exit(contains(message, "the image decoder's process has ended") ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

TEST_F(Decoding, InterruptEndsTheWait)
{
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    test::writeBytes(folder / "busy.png", "TEST work");
    EXPECT_EXIT(
        {
            catchInterrupts();
            std::thread user([] {
                std::this_thread::sleep_for(200ms);
                kill(getpid(), SIGINT);
            });
            user.detach();
            try {
                readImage(folder / "busy.png");
            } catch (const Interrupted&) {
                std::exit(0);
            }
            std::exit(1);
        },
        testing::ExitedWithCode(0), "");
}

// Printed by hand: --gtest_also_run_disabled_tests --gtest_filter='*DISABLED_Cost*'
TEST_F(Decoding, DISABLED_CostOfAProcess)
{
    const auto milliseconds = [](const auto& work) {
        const auto start = Clock::now();
        work();
        return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    };
    std::printf("image           here, ms  process, ms  difference, ms\n");
    for (const char* ending : test::kReadEndings)
        for (const int size : {64, 1024, 2048}) {
            const fs::path file = folder / (std::string("a.") + ending);
            test::writeImageFile(file, size, size);
            std::vector<double> here, elsewhere;
            for (int i = 0; i < 9; ++i) {
                here.push_back(milliseconds([&] { decodedHere(file); }));
                elsewhere.push_back(milliseconds([&] { readImage(file); }));
            }
            std::nth_element(here.begin(), here.begin() + 4, here.end());
            std::nth_element(elsewhere.begin(), elsewhere.begin() + 4, elsewhere.end());
            std::printf("%-4s %4d x %4d %8.1f %12.1f %12.1f\n", ending, size, size, here[4], elsewhere[4],
                        elsewhere[4] - here[4]);
        }
}

TEST_F(Decoding, OnlyOneDecoderIsStarted)
{
    EXPECT_THROW(DecoderProcess(), std::logic_error);
}

} // namespace
} // namespace lumel
