// What several invocations change at once is changed atomically: checked in the SPIR-V of every shader.
#include "gpu/pipeline.h"
#include <gtest/gtest.h>
#include <map>
#include <set>

using namespace lumel;

namespace {

// Members of structs in memory as "Struct.member", by how one shader changes them.
struct Changes {
    std::set<std::string> atomically, plainly;
};

// SPIR-V specification, section 3.
class SpirvReader {
public:
    explicit SpirvReader(std::span<const uint32_t> code)
    {
        for (size_t at = 5; at < code.size(); at += code[at] >> 16)
            read(code.subspan(at, code[at] >> 16), code[at] & 0xffffu);
    }
    Changes changes;

private:
    enum Op : uint32_t {
        OpName = 5,
        OpMemberName = 6,
        OpTypeArray = 28,
        OpTypeRuntimeArray = 29,
        OpTypeStruct = 30,
        OpTypePointer = 32,
        OpConstant = 43,
        OpFunctionParameter = 55,
        OpFunctionCall = 57,
        OpVariable = 59,
        OpLoad = 61,
        OpStore = 62,
        OpAccessChain = 65,
        OpConvertUToPtr = 120,
        OpBitcast = 124,
        OpAtomicExchange = 229,
        OpAtomicXor = 242
    };
    static constexpr uint32_t kPhysicalStorageBuffer = 5349; // storage class
    using Words = std::span<const uint32_t>;

    void read(Words words, uint32_t op)
    {
        const auto text = [&](size_t from) {
            return std::string(reinterpret_cast<const char*>(words.data() + from));
        };
        if (op >= OpAtomicExchange && op <= OpAtomicXor)
            changes.atomically.insert(member_[words[3]]);
        switch (op) {
        case OpName:
            names_[words[1]] = text(2);
            break;
        case OpMemberName:
            members_[{words[1], words[2]}] = text(3);
            break;
        case OpTypeArray:
        case OpTypeRuntimeArray:
            elements_[words[1]] = words[2];
            break;
        case OpTypeStruct:
            structs_[words[1]].assign(words.begin() + 2, words.end());
            break;
        case OpTypePointer:
            pointees_[words[1]] = words[3];
            if (words[2] == kPhysicalStorageBuffer)
                inMemory_.insert(words[1]);
            break;
        case OpConstant:
            constants_[words[2]] = words[3];
            break;
        case OpStore:
            store(words[1]);
            break;
        case OpAccessChain:
            follow(words);
            [[fallthrough]];
        case OpFunctionParameter:
        case OpFunctionCall:
        case OpVariable:
        case OpLoad:
        case OpConvertUToPtr:
        case OpBitcast:
            types_[words[2]] = words[1];
            break;
        default:
            break;
        }
    }

    // A struct is stored with all of its members; copies in registers are private.
    void store(uint32_t pointer)
    {
        const uint32_t type = types_[pointer];
        if (!inMemory_.contains(type))
            return;
        changes.plainly.insert(member_[pointer]);
        if (const auto stored = structs_.find(pointees_[type]); stored != structs_.end())
            for (uint32_t i = 0; i < stored->second.size(); ++i)
                changes.plainly.insert(names_[stored->first] + "." + members_[{stored->first, i}]);
    }

    // The innermost member that an access chain goes through.
    void follow(Words words)
    {
        std::string found = member_[words[3]];
        uint32_t type = pointees_[types_[words[3]]];
        for (const uint32_t index : words.subspan(4)) {
            if (const auto inside = structs_.find(type); inside != structs_.end()) {
                found = names_[type] + "." + members_[{type, constants_[index]}];
                type = inside->second.at(constants_[index]);
            } else {
                type = elements_[type]; // 0 for a vector's, which no further index follows
            }
        }
        member_[words[2]] = found;
    }

    std::map<uint32_t, std::string> names_, member_; // member_: by pointer
    std::map<std::pair<uint32_t, uint32_t>, std::string> members_;
    std::map<uint32_t, uint32_t> elements_, pointees_, constants_, types_;
    std::map<uint32_t, std::vector<uint32_t>> structs_;
    std::set<uint32_t> inMemory_; // pointer types
};

} // namespace

// A plain store beside an atomic operation undoes what other invocations did in between. That is also what
// writing a struct back does that was read as a whole.
TEST(Atomics, WhatIsChangedAtomicallyIsNotStoredByTheSameShader)
{
    std::set<std::string> seen;
    for (const std::string& name : gpu::shaderNames()) {
        Changes changes = SpirvReader(gpu::shaderCode(name)).changes;
        changes.atomically.erase(""); // variables of a workgroup
        for (const std::string& member : changes.atomically) {
            EXPECT_FALSE(changes.plainly.contains(member)) << name << " stores " << member;
            seen.insert(member);
        }
    }
    for (const char* member :
         {"TileState.needed", "TileState.change", "Plan.marked", "Job.count", "ObjectFeedback.level"})
        EXPECT_TRUE(seen.contains(member)) << member; // the reader reads
}
