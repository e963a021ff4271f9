// Who compiles a pipeline, and when it is not.
#include "gpu/pipeline_compiler.h"
#include <gtest/gtest.h>
#include <stdexcept>

namespace lumel::gpu {
namespace {

std::shared_ptr<Compilation> counting(std::atomic<int>& made)
{
    return std::make_shared<Compilation>([&made] {
        ++made;
        return vk::raii::Pipeline(nullptr);
    });
}

} // namespace

TEST(PipelineCompiler, EachIsCompiledOnceWhoeverDoesIt)
{
    std::atomic<int> made = 0;
    PipelineCompiler compiler;
    std::vector<std::shared_ptr<Compilation>> all;
    for (int i = 0; i < 200; ++i)
        compiler.add(all.emplace_back(counting(made)));
    for (const auto& compilation : all)
        compilation->take();
    EXPECT_EQ(made, 200);
}

TEST(PipelineCompiler, WhatIsNeededIsCompiledAtOnce)
{
    std::atomic<int> made = 0;
    const auto compilation = counting(made); // in no queue
    compilation->take();
    EXPECT_EQ(made, 1);
}

TEST(PipelineCompiler, WhatIsNotWantedAnyMoreIsNotCompiled)
{
    std::atomic<int> made = 0;
    const auto compilation = counting(made);
    compilation->drop();
    {
        PipelineCompiler compiler;
        compiler.add(compilation);
    }
    EXPECT_EQ(made, 0);
}

TEST(PipelineCompiler, WhoUsesItHearsWhatWentWrong)
{
    PipelineCompiler compiler;
    const auto compilation = std::make_shared<Compilation>(
        []() -> vk::raii::Pipeline { throw std::runtime_error("no such device"); });
    compiler.add(compilation);
    EXPECT_THROW(compilation->take(), std::runtime_error);
}

} // namespace lumel::gpu
