// What the program tells the user goes to stderr, by spdlog::info, warn, error. stdout carries results.
#pragma once
#include <spdlog/spdlog.h>

namespace lumel {
// Plain lines without time stamps. level: "debug", "info", "warn", "error" or "off".
void setUpLog(const std::string& level);
} // namespace lumel
