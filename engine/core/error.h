// Wrong input (files, options, devices) is reported by throwing Error; main() prints its one line and
// exits with 1. The message names the file and the remedy: "rock.png: empty file; export it again".
// Programmer errors are assert()s.
#pragma once
#include <stdexcept>

namespace lumel {

struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Thrown by Progress when the user pressed Ctrl-C: main() exits with 130 and no output is left behind.
struct Interrupted : std::runtime_error {
    Interrupted() : std::runtime_error("interrupted") {}
};

} // namespace lumel
