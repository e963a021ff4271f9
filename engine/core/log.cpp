#include "log.h"
#include <spdlog/sinks/stdout_sinks.h>

namespace lumel {

void setUpLog(const std::string& level)
{
    auto logger =
        std::make_shared<spdlog::logger>("lumel", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    logger->set_pattern("%v");
    logger->set_level(spdlog::level::from_str(level));
    spdlog::set_default_logger(std::move(logger));
}

} // namespace lumel
