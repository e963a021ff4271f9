#include "core/error.h"
#include "core/file.h"
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <sys/stat.h>
#include <unistd.h>

namespace lumel {
namespace {

namespace fs = std::filesystem;

struct Files : testing::Test {
    fs::path folder;

    Files()
    {
        std::string pattern = (fs::temp_directory_path() / "lumel-test-XXXXXX").string();
        folder = mkdtemp(pattern.data());
    }
    ~Files() override
    {
        fs::permissions(folder, fs::perms::owner_all);
        fs::remove_all(folder);
    }

    static std::string text(const fs::path& file)
    {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    size_t count() const { return size_t(std::distance(fs::directory_iterator(folder), {})); }

    template<class Action>
    static std::string errorOf(const Action& action)
    {
        try {
            action();
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
    static bool contains(const std::string& text, const std::string& part)
    {
        return text.find(part) != std::string::npos;
    }
};

TEST_F(Files, AreReadWhole)
{
    const std::string bytes("a\0b\r\n\xff", 6);
    std::ofstream(folder / "data", std::ios::binary) << bytes;
    const auto read = readFile(folder / "data");
    ASSERT_EQ(read.size(), 6u);
    EXPECT_EQ(std::memcmp(read.data(), bytes.data(), 6), 0);
    std::ofstream(folder / "empty");
    EXPECT_TRUE(readFile(folder / "empty").empty());
}

TEST_F(Files, ThatCannotBeReadAreNamed)
{
    for (const fs::path& file : {folder / "missing", folder})
        EXPECT_TRUE(contains(errorOf([&] { readFile(file); }), file.string()));
    // A pipe would block.
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_TRUE(contains(errorOf([&] { readFile(folder / "pipe"); }), "not a regular file"));
    std::ofstream(folder / "large") << "12345";
    EXPECT_TRUE(contains(errorOf([&] { readFile(folder / "large", 4); }), "limit of 4"));
}

TEST_F(Files, AppearWholeAndReplaceOthers)
{
    const fs::path file = folder / "out.json";
    writeFileAtomically(file, "first");
    EXPECT_EQ(text(file), "first");
    writeFileAtomically(file, "second");
    EXPECT_EQ(text(file), "second");
    EXPECT_EQ(count(), 1u) << "no temporary is left";
}

TEST_F(Files, LeftByKilledProcessesAreRemovedAndNoOthers)
{
    const std::string mark = processMark(), host = mark.substr(mark.find('-'));
    const auto make = [&](const std::string& name) { std::ofstream(folder / name) << "part"; };
    const std::string dead = ".out.4194305" + host + ".json", living = ".out." + mark + ".json";
    const std::string elsewhere = ".out.17-elsewhere.json", forgotten = ".out.18-elsewhere.json";
    for (const auto& name : {dead, living, elsewhere, forgotten, std::string(".out.notes.json")})
        make(name);
    fs::last_write_time(folder / forgotten, fs::file_time_type::clock::now() - std::chrono::hours(1));
    removeLeftovers(folder / "out.json");
    EXPECT_FALSE(fs::exists(folder / dead));
    EXPECT_FALSE(fs::exists(folder / forgotten));
    EXPECT_EQ(count(), 3u) << "what living processes write stays, and what is no temporary file";
}

TEST_F(Files, StayAsTheyWereWhenWritingFails)
{
    const fs::path file = folder / "out.json";
    writeFileAtomically(file, "good");
    const auto failing = [&] {
        writeAtomically(file, [&](const fs::path& temporary) {
            EXPECT_NE(temporary, file);
            EXPECT_EQ(temporary.extension(), file.extension()) << "writers choose the format by it";
            EXPECT_EQ(temporary.parent_path(), file.parent_path()) << "renaming must not cross file systems";
            std::ofstream(temporary) << "half of the da";
            throw Error("disk full");
        });
    };
    EXPECT_EQ(errorOf(failing), "disk full");
    EXPECT_EQ(text(file), "good");
    EXPECT_EQ(count(), 1u);
}

TEST_F(Files, LeaveNothingBehindAfterCtrlC)
{
    EXPECT_THROW(writeAtomically(folder / "out.exr",
                                 [&](const fs::path& temporary) {
                                     std::ofstream(temporary) << "half";
                                     throw Interrupted();
                                 }),
                 Interrupted);
    EXPECT_EQ(count(), 0u);
}

TEST_F(Files, ThatCannotBeWrittenAreNamed)
{
    const fs::path orphan = folder / "no such folder" / "out.json";
    EXPECT_TRUE(contains(errorOf([&] { writeFileAtomically(orphan, "x"); }), orphan.string()));
    fs::create_directory(folder / "taken");
    EXPECT_TRUE(contains(errorOf([&] { writeFileAtomically(folder / "taken", "x"); }), "is a folder"));
    if (geteuid() == 0)
        GTEST_SKIP() << "root may write everywhere";
    fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_TRUE(contains(errorOf([&] { writeFileAtomically(folder / "out", "x"); }), "not writable"));
}

TEST_F(Files, CacheFolderFollowsTheXdgSpecification)
{
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    EXPECT_EQ(cacheFolder(), folder / "lumel");
    EXPECT_TRUE(fs::is_directory(folder / "lumel"));
    setenv("HOME", (folder / "home").c_str(), 1);
    for (const char* ignored : {"", "relative/path"}) {
        setenv("XDG_CACHE_HOME", ignored, 1);
        EXPECT_EQ(cacheFolder(), folder / "home" / ".cache" / "lumel");
    }
    std::ofstream(folder / "file");
    setenv("XDG_CACHE_HOME", (folder / "file").c_str(), 1);
    EXPECT_TRUE(contains(errorOf([] { cacheFolder(); }), "XDG_CACHE_HOME"));
}

TEST(ContentHash, DependsOnEveryByteAndTheirOrder)
{
    std::set<std::string> seen;
    std::string bytes(37, 'a');
    seen.insert(ContentHash().add(bytes).hex());
    for (size_t i = 0; i < bytes.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            std::string changed = bytes;
            changed[i] = char(changed[i] ^ (1 << bit));
            EXPECT_TRUE(seen.insert(ContentHash().add(changed).hex()).second);
        }
    for (size_t size = 0; size < bytes.size(); ++size)
        EXPECT_TRUE(seen.insert(ContentHash().add(std::string(size, 'a')).hex()).second);
    EXPECT_NE(ContentHash().addValue(1).addValue(2).hex(), ContentHash().addValue(2).addValue(1).hex());
}

TEST(ContentHash, BothHalvesChange)
{
    // Each half is a hash of its own: a change that only one of them saw would halve the key.
    const std::string a = ContentHash().add(std::string("one")).hex(),
                      b = ContentHash().add(std::string("two")).hex();
    ASSERT_EQ(a.size(), 32u);
    EXPECT_EQ(a.find_first_not_of("0123456789abcdef"), std::string::npos);
    EXPECT_NE(a.substr(0, 16), b.substr(0, 16));
    EXPECT_NE(a.substr(16), b.substr(16));
    EXPECT_NE(a.substr(0, 16), a.substr(16));
}

TEST(ContentHash, NeighbouringTextsStaySeparate)
{
    const std::string ab = "ab", c = "c", a = "a", bc = "bc";
    EXPECT_NE(ContentHash().add(ab).add(c).hex(), ContentHash().add(a).add(bc).hex());
}

TEST(ContentHash, IsTheSameEverywhere)
{
    // Keys outlive builds: a change of the function must be deliberate.
    EXPECT_EQ(ContentHash().add(std::string("lumel")).hex(), ContentHash().add(std::string("lumel")).hex());
    EXPECT_EQ(ContentHash().hex(), "cbf29ce48422232584222325cbf29ce4");
}

TEST_F(Files, MappedBytesOutliveTheFile)
{
    writeFileAtomically(folder / "a", "mapped");
    writeFileAtomically(folder / "empty", "");
    const MappedFile file(folder / "a"), empty(folder / "empty");
    fs::remove(folder / "a");
    EXPECT_EQ(std::memcmp(file.bytes().data(), "mapped", file.bytes().size()), 0);
    EXPECT_EQ(file.bytes().size(), 6u);
    EXPECT_TRUE(empty.bytes().empty());
    EXPECT_THROW(MappedFile{folder / "a"}, Error);
    EXPECT_THROW(MappedFile{folder}, Error);
}

TEST_F(Files, WhatWasUsedLeastRecentlyMakesRoom)
{
    for (const char* name : {"a", "b", "c"}) {
        writeFileAtomically(folder / name, "12345678");
        const timespec old[2] = {{.tv_sec = 1000 + name[0], .tv_nsec = 0}, {.tv_sec = 1000, .tv_nsec = 0}};
        ASSERT_EQ(utimensat(AT_FDCWD, (folder / name).c_str(), old, 0), 0);
    }
    deleteUnused(folder, 24);
    EXPECT_EQ(count(), 3u);
    const auto written = fs::last_write_time(folder / "a");
    markUsed(folder / "a");
    EXPECT_EQ(fs::last_write_time(folder / "a"), written);
    deleteUnused(folder, 20);
    EXPECT_TRUE(fs::exists(folder / "a"));
    EXPECT_FALSE(fs::exists(folder / "b"));
    EXPECT_TRUE(fs::exists(folder / "c"));
    deleteUnused(folder / "missing", 0); // no error
}

} // namespace
} // namespace lumel
